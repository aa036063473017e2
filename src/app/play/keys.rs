//! Keys.

use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::prelude::*;

use super::sandbox::Sandbox;
use crate::panel::{Asked, Choice, Tool, Wish};
use crate::view::Axis;

/// Whether a text field has the keyboard.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct KeysOnPanel(pub bool);

/// By how much [ and ] change the brush.
const BRUSH_STEP: f32 = 1.2;

pub(super) fn press(
    mut messages: MessageReader<KeyboardInput>,
    held: Res<ButtonInput<KeyCode>>,
    on_panel: Option<Res<KeysOnPanel>>,
    mut sandbox: ResMut<Sandbox>,
) {
    let is_held = |keys: [KeyCode; 2]| held.any_pressed(keys);
    let control = is_held([KeyCode::ControlLeft, KeyCode::ControlRight]);
    let shift = is_held([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    let typing = on_panel.is_some_and(|on_panel| on_panel.0);
    for message in messages.read().filter(|message| message.state.is_pressed()) {
        if typing && message.logical_key != Key::Escape && !control {
            continue;
        }
        let sandbox = &mut *sandbox;
        match &message.logical_key {
            Key::Character(character) => {
                character_key(sandbox, &character.to_lowercase(), control, shift, message.repeat);
            }
            key if !message.repeat || matches!(key, Key::ArrowLeft | Key::ArrowRight) => named_key(sandbox, key),
            _ => {}
        }
    }
}

fn character_key(sandbox: &mut Sandbox, character: &str, control: bool, shift: bool, repeat: bool) {
    let choice = &mut sandbox.choice;
    // Undo, redo and the brush go on while the key is held.
    match (character, control) {
        ("z", true) => return sandbox.wishes.push(if shift { Wish::Redo } else { Wish::Undo }),
        ("y", true) => return sandbox.wishes.push(Wish::Redo),
        ("[", false) => return choice.brush_size = (choice.brush_size / BRUSH_STEP).max(0.005),
        ("]", false) => return choice.brush_size = (choice.brush_size * BRUSH_STEP).min(0.5),
        _ if repeat => return,
        _ => {}
    }
    let from = |front, back| Wish::LookFrom(if control { back } else { front });
    match (character, control) {
        ("s", true) => sandbox.wishes.push(if shift { Wish::Ask(Asked::SaveScene) } else { Wish::Save }),
        #[cfg(feature = "record")]
        ("r", true) => {
            let title = sandbox.open.as_ref().map_or_else(String::new, |open| open.title());
            crate::panel::open_record(choice, &title);
        }
        ("o", true) => sandbox.wishes.push(Wish::Ask(Asked::Open)),
        ("f", false) => sandbox.wishes.push(Wish::Frame),
        ("1", _) => sandbox.wishes.push(from(Axis::Front, Axis::Back)),
        ("3", _) => sandbox.wishes.push(from(Axis::Right, Axis::Left)),
        ("7", _) => sandbox.wishes.push(from(Axis::Top, Axis::Bottom)),
        ("t", false) => choice.turntable = !choice.turntable,
        ("v", false) => choice.tool = Tool::Orbit,
        ("b", false) => choice.tool = Tool::Paint,
        ("g", false) => choice.tool = Tool::Fill,
        ("?", _) => choice.help = !choice.help,
        _ => {}
    }
}

fn named_key(sandbox: &mut Sandbox, key: &Key) {
    let keys: Vec<f32> = sandbox.snapshot.film.iter().map(|state| state.lambda).collect();
    let player = &mut sandbox.choice.player;
    match key {
        Key::Space if keys.len() > 1 => player.toggle(),
        Key::ArrowLeft => player.step(&keys, false),
        Key::ArrowRight => player.step(&keys, true),
        Key::Home => player.scrub(0.0),
        Key::End => player.scrub(1.0),
        Key::F1 => sandbox.choice.help = !sandbox.choice.help,
        Key::F12 => sandbox.wishes.push(Wish::Screenshot),
        Key::Escape => escape(sandbox),
        _ => {}
    }
}

/// Drops what is nearest at hand: the stroke, a dialog, the solve.
fn escape(sandbox: &mut Sandbox) {
    if sandbox.open.as_mut().is_some_and(|open| open.painting.cancel()) || close_dialogs(&mut sandbox.choice) {
        return;
    }
    if sandbox.problem.is_some() {
        sandbox.problem = None;
    } else {
        sandbox.wishes.push(Wish::Cancel);
    }
}

/// Whether one was open.
fn close_dialogs(choice: &mut Choice) -> bool {
    // It lies over the others, which stay.
    if choice.prompt.take().is_some() {
        return true;
    }
    let was_open = choice.help || choice.export.is_open || choice.gallery;
    (choice.help, choice.export.is_open, choice.gallery) = (false, false, false);
    #[cfg(feature = "record")]
    let was_open = std::mem::take(&mut choice.record.is_open) || was_open;
    was_open
}
