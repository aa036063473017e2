//! How panels look: one accent colour, three sizes of text, distances in multiples of four points.

use bevy_egui::egui::{
    self, Color32, Context, CornerRadius, FontFamily, FontId, Frame, Margin, Response, RichText, Shadow, Stroke,
    TextStyle, Ui, Vec2, Visuals,
};

/// Width of the side panels, points: both leave a view of 680 at 1280.
pub const SIDE: f32 = 292.0;

/// What is chosen, what can be done next.
pub const ACCENT: Color32 = Color32::from_rgb(0x2b, 0x6c, 0xd4);
/// Certified.
pub const GREEN: Color32 = Color32::from_rgb(0x16, 0x7a, 0x42);
/// Being solved.
pub const AMBER: Color32 = Color32::from_rgb(0xa8, 0x62, 0x00);
/// Not certified, or an error.
pub const RED: Color32 = Color32::from_rgb(0xc4, 0x2b, 0x2b);

const TEXT: Color32 = Color32::from_rgb(0x1a, 0x1e, 0x24);
const WEAK: Color32 = Color32::from_rgb(0x54, 0x5c, 0x67);
const PANEL: Color32 = Color32::from_rgb(0xf6, 0xf7, 0xf8);
const FIELD: Color32 = Color32::from_rgb(0xff, 0xff, 0xff);
const BUTTON: Color32 = Color32::from_rgb(0xe8, 0xea, 0xed);
const HOVERED: Color32 = Color32::from_rgb(0xdd, 0xe1, 0xe7);
const PRESSED: Color32 = Color32::from_rgb(0xcd, 0xd4, 0xde);
const LINE: Color32 = Color32::from_rgb(0xd9, 0xdd, 0xe2);
const CHOSEN: Color32 = Color32::from_rgb(0xd8, 0xe6, 0xfb);

/// Sets colours, sizes and distances. Once.
pub fn apply(ctx: &Context) {
    ctx.set_theme(egui::Theme::Light);
    ctx.style_mut_of(egui::Theme::Light, |style| {
        style.text_styles = [
            (TextStyle::Heading, 15.0, FontFamily::Proportional),
            (TextStyle::Body, 13.0, FontFamily::Proportional),
            (TextStyle::Button, 13.0, FontFamily::Proportional),
            (TextStyle::Small, 11.0, FontFamily::Proportional),
            (TextStyle::Monospace, 12.0, FontFamily::Monospace),
        ]
        .map(|(style, size, family)| (style, FontId::new(size, family)))
        .into();
        let spacing = &mut style.spacing;
        spacing.item_spacing = Vec2::new(8.0, 5.0);
        spacing.button_padding = Vec2::new(8.0, 3.0);
        spacing.interact_size = Vec2::new(40.0, 22.0);
        spacing.slider_width = 118.0;
        spacing.combo_width = 96.0;
        spacing.icon_width = 16.0;
        spacing.tooltip_width = 320.0;
        spacing.menu_margin = Margin::same(6);
        spacing.window_margin = Margin::same(16);
        spacing.scroll = egui::style::ScrollStyle::thin();
        // The bar beside it tells that there is more; a veil over the last line would only hide it.
        spacing.scroll.fade.strength = 0.0;
        style.interaction.tooltip_delay = 0.4;
        style.visuals = visuals();
    });
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::light();
    visuals.override_text_color = None;
    visuals.weak_text_color = Some(WEAK);
    visuals.panel_fill = PANEL;
    visuals.window_fill = PANEL;
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.window_shadow = Shadow { offset: [0, 6], blur: 24, spread: 0, color: Color32::from_black_alpha(40) };
    visuals.popup_shadow = Shadow { offset: [0, 3], blur: 12, spread: 0, color: Color32::from_black_alpha(36) };
    visuals.extreme_bg_color = FIELD;
    visuals.faint_bg_color = Color32::from_rgb(0xef, 0xf1, 0xf3);
    visuals.selection.bg_fill = CHOSEN;
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(0x17, 0x4d, 0xa6));
    visuals.hyperlink_color = ACCENT;
    visuals.warn_fg_color = AMBER;
    visuals.error_fg_color = RED;
    visuals.slider_trailing_fill = true;
    visuals.indent_has_left_vline = false;
    let widgets = &mut visuals.widgets;
    for (state, fill, text) in [
        (&mut widgets.noninteractive, PANEL, TEXT),
        (&mut widgets.inactive, BUTTON, TEXT),
        (&mut widgets.hovered, HOVERED, TEXT),
        (&mut widgets.active, PRESSED, TEXT),
        (&mut widgets.open, HOVERED, TEXT),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = Stroke::NONE;
        state.fg_stroke = Stroke::new(1.0, text);
        state.corner_radius = CornerRadius::same(5);
        state.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    // Boxes to tick and the rails of sliders are told from the ground by their rim.
    widgets.inactive.bg_fill = Color32::from_rgb(0xe3, 0xe6, 0xea);
    widgets.inactive.bg_stroke = Stroke::new(1.0, Color32::from_rgb(0xc9, 0xce, 0xd6));
    widgets.hovered.bg_stroke = Stroke::new(1.0, Color32::from_rgb(0xae, 0xb6, 0xc2));
    widgets.active.bg_stroke = Stroke::new(1.0, ACCENT);
    visuals
}

/// Around the side panels.
pub fn side_frame() -> Frame {
    Frame::new().fill(PANEL).inner_margin(Margin { left: 14, right: 6, top: 10, bottom: 8 })
}

/// Around the bars above and below.
pub fn bar_frame() -> Frame {
    Frame::new().fill(PANEL).inner_margin(Margin::symmetric(14, 7))
}

/// A side panel that scrolls where it must.
pub fn scroll(ui: &mut Ui, id: &str, content: impl FnOnce(&mut Ui)) {
    egui::ScrollArea::vertical().id_salt(id).auto_shrink(false).show(ui, |ui| {
        ui.set_width(SIDE - 32.0);
        content(ui);
    });
}

/// A part of a panel with a title.
pub fn section(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    ui.add_space(2.0);
    ui.label(RichText::new(title).heading().strong());
    ui.add_space(2.0);
    content(ui);
    ui.add_space(6.0);
    ui.separator();
}

/// A part that can be folded away.
pub fn folded(ui: &mut Ui, title: &str, open: bool, content: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).color(WEAK)).default_open(open).show_unindented(ui, |ui| {
        ui.add_space(2.0);
        content(ui);
    });
}

/// A name, and what it stands for at a fixed distance to the right.
pub fn row<R>(ui: &mut Ui, name: &str, hint: &str, content: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let size = Vec2::new(76.0, ui.spacing().interact_size.y);
        let left = egui::Layout::left_to_right(egui::Align::Center);
        let label = ui.allocate_ui_with_layout(size, left, |ui| {
            ui.set_min_size(size);
            ui.label(RichText::new(name).color(WEAK))
        });
        if !hint.is_empty() {
            label.inner.on_hover_text(hint);
        }
        content(ui)
    })
    .inner
}

/// A dialog in the middle of the window, as large as what is in it.
pub fn dialog<'open>(ctx: &egui::Context, title: &'open str, is_open: &'open mut bool) -> egui::Window<'open> {
    egui::Window::new(title)
        .open(is_open)
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
}

/// Text in the background.
pub fn weak(text: impl Into<String>) -> RichText {
    RichText::new(text).color(WEAK)
}

/// A button that stands for the next step.
pub fn primary(ui: &mut Ui, text: &str) -> Response {
    // White on a colour that fades would not be read.
    if !ui.is_enabled() {
        return ui.button(text);
    }
    let text = RichText::new(text).color(Color32::WHITE);
    ui.add(egui::Button::new(text).fill(ACCENT))
}

/// A few choices side by side.
pub fn choices<T: PartialEq + Copy>(ui: &mut Ui, value: &mut T, all: &[(T, &str, &str)]) -> bool {
    let before = *value;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = Vec2::new(3.0, 4.0);
        ui.spacing_mut().button_padding.x = 6.0;
        for &(choice, name, hint) in all {
            let response = ui.selectable_value(value, choice, name);
            if !hint.is_empty() {
                response.on_hover_text(hint);
            }
        }
    });
    before != *value
}
