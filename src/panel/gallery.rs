//! The gallery: everything built in, as pictures to choose from.

use std::sync::Arc;

use bevy_egui::egui::{
    self, Align2, Color32, ColorImage, Context, CornerRadius, FontId, Id, Rect, Sense, Stroke, StrokeKind,
    TextureHandle, TextureOptions, Ui, Vec2,
};

use super::{Choice, Wish, theme};
use crate::gallery::{self, Entry, thumbnails::thumbnail};
use crate::scene::Source;

/// Side of a picture, points: six beside each other fit between the panels of a window 1280 wide, and over them.
const SIDE: f32 = 124.0;

/// Around a picture, and below it for its name.
const RIM: f32 = 5.0;
const NAME: f32 = 20.0;

/// Between pictures.
const SPACE: f32 = 6.0;

const COLUMNS: usize = 6;

/// Over everything, until something is chosen or it is closed.
pub(super) fn show(ctx: &Context, open: Option<&Source>, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    if !choice.gallery {
        return;
    }
    let textures = textures(ctx);
    let mut chosen = None;
    theme::dialog(ctx, "Gallery", &mut choice.gallery).show(ctx, |ui| {
        ui.label(theme::weak("Each is warped as soon as it is open. Rest the pointer on one to read what it shows."));
        ui.add_space(4.0);
        let highest = (ctx.content_rect().height() - 140.0).max(200.0);
        // As high as all rows where there is room: a window alone would show two of them and scroll.
        let rows = textures.len().div_ceil(COLUMNS) as f32 * (SIDE + NAME + 2.0 * RIM + SPACE);
        let area = egui::ScrollArea::vertical().max_height(highest).min_scrolled_height(rows.min(highest));
        area.show(ui, |ui| {
            egui::Grid::new("gallery").spacing(Vec2::splat(SPACE)).show(ui, |ui| {
                for (k, (entry, texture)) in textures.iter().enumerate() {
                    let is_open = matches!(open, Some(Source::Gallery(name)) if name == entry.name);
                    if card(ui, entry, texture.as_ref(), is_open) {
                        chosen = Some(entry.name);
                    }
                    if k % COLUMNS == COLUMNS - 1 {
                        ui.end_row();
                    }
                }
            });
        });
    });
    if let Some(name) = chosen {
        wishes.push(Wish::Open(Source::Gallery(name.into())));
        choice.gallery = false;
    }
}

/// Which part of the window a scene of the gallery is.
pub fn card_id(name: &str) -> Id {
    Id::new(("gallery", name))
}

/// A picture with its name. Whether it was clicked.
fn card(ui: &mut Ui, entry: &Entry, texture: Option<&TextureHandle>, is_open: bool) -> bool {
    let size = Vec2::new(SIDE + 2.0 * RIM, SIDE + NAME + 2.0 * RIM);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let response = ui.interact(rect, card_id(entry.name), Sense::click());
    let visuals = ui.visuals();
    let (fill, line, ink) = if is_open {
        (visuals.selection.bg_fill, visuals.selection.stroke.color, visuals.selection.stroke.color)
    } else if response.hovered() {
        (visuals.widgets.hovered.bg_fill, theme::ACCENT, visuals.text_color())
    } else {
        (Color32::TRANSPARENT, Color32::TRANSPARENT, visuals.text_color())
    };
    let painter = ui.painter();
    painter.rect(rect, CornerRadius::same(8), fill, Stroke::new(1.0, line), StrokeKind::Inside);
    let picture = Rect::from_min_size(rect.min + Vec2::splat(RIM), Vec2::splat(SIDE));
    if let Some(texture) = texture {
        egui::Image::from_texture(texture).corner_radius(5).paint_at(ui, picture);
    }
    let foot = picture.center_bottom() + Vec2::new(0.0, 0.5 * NAME + 1.0);
    let layout = |size: f32| ui.painter().layout_no_wrap(entry.name.into(), FontId::proportional(size), ink);
    let natural = layout(13.0);
    // The longest name is wider than a picture.
    let name = if natural.size().x > SIDE { layout(13.0 * SIDE / natural.size().x) } else { natural };
    let place = Align2::CENTER_CENTER.anchor_size(foot, name.size());
    ui.painter().galley(place.min, name, ink);
    response
        .on_hover_cursor(egui::CursorIcon::PointingHand)
        .on_hover_text(format!("{}\n\nSource: {}", entry.one_line, entry.reference))
        .clicked()
}

/// Every scene and its picture, decoded when the gallery is first shown.
type Textures = Arc<Vec<(Entry, Option<TextureHandle>)>>;

fn textures(ctx: &Context) -> Textures {
    let id = Id::new("gallery textures");
    if let Some(known) = ctx.data(|data| data.get_temp::<Textures>(id)) {
        return known;
    }
    let texture = |entry: Entry| {
        let decoded = thumbnail(entry.name).and_then(|bytes| image::load_from_memory(bytes).ok());
        let loaded = decoded.map(|picture| {
            let picture = picture.to_rgb8();
            let size = [picture.width() as usize, picture.height() as usize];
            ctx.load_texture(entry.name, ColorImage::from_rgb(size, picture.as_raw()), TextureOptions::LINEAR)
        });
        (entry, loaded)
    };
    let all: Textures = Arc::new(gallery::everything().map(texture).collect());
    ctx.data_mut(|data| data.insert_temp(id, all.clone()));
    all
}
