//! A scenario read from a file, for tests of the real window: a line at a time it moves the pointer, presses keys, waits
//! and looks.
//!
//! ```text
//! wait done                 until the solver is done (or `lattice`, `idle`: nothing is read or written, `preview`: of a film)
//! frames 3                  so many frames
//! move 640 360              the pointer, logical pixels; `drag 600 300 680 300 8 left` presses, moves in steps, lets go
//! wheel 2                   clicks away from the user
//! key z ctrl shift          `z`, `[`, `space`, `left`, `escape`, `f12`, …
//! open body.obj             as if dropped; `save s.ron`, `mesh out.glb`, `growth out.glb`, `report out.json`
//! film out.mp4 160 90 1 10  records: width, height, seconds, frames a second; `wait film` until it is there
//! mode fidelity             `plain`, `importance`, `voxels`; `show ghost|sizes|beside|wipe|help|gallery|export|record` toggles
//! shot a.png                a picture of the window
//! expect problem TEXT       or `expect strokes 2`, `expect lambda 0.5`, `expect wipe 0.4`, `expect calm`; the program ends with an error if not
//! resize 1920 1080
//! quit
//! ```

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::mouse::{MouseButtonInput, MouseScrollUnit, MouseWheel};
use bevy::prelude::*;
use bevy::window::{CursorMoved, PrimaryWindow, WindowEvent};

use super::drawn;
use super::sandbox::Sandbox;
use crate::app::note;
use crate::panel::{Asked, Compare, Wish};
use crate::session::Phase;
use crate::view::{Mode, Unhurried, VoxelColour};
use crate::{Error, Result};

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(240);

/// Lines still to be done.
#[derive(Resource)]
pub(super) struct Script {
    lines: VecDeque<String>,
    /// Frames to let pass before the next line.
    frames: u32,
    waiting_since: Option<Instant>,
    pointer: Vec2,
    /// Whether the renderer waits for no shader.
    is_drawn: Arc<AtomicBool>,
}

impl Script {
    /// Reads a scenario.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::reading(path, e))?;
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
        let lines = lines.map(str::to_owned).collect();
        Ok(Self { lines, frames: 0, waiting_since: None, pointer: Vec2::ZERO, is_drawn: Arc::default() })
    }
}

/// Runs a scenario in an app with a window.
pub(super) fn build(app: &mut App, mut script: Script) {
    script.is_drawn = drawn::watch(app);
    app.insert_resource(script)
        .insert_resource(bevy::winit::WinitSettings::continuous())
        // Before Bevy turns messages into the state of buttons and keys, as the window's own would come.
        .add_systems(First, act);
}

/// Everything a line may touch.
struct Stage<'a> {
    world: &'a mut World,
    window: Entity,
}

fn act(world: &mut World) {
    world.insert_resource(bevy::winit::WinitSettings::continuous());
    let mut windows = world.query_filtered::<Entity, With<PrimaryWindow>>();
    let Ok(window) = windows.single(world) else { return };
    world.resource_scope(|world, mut script: Mut<Script>| {
        if script.frames > 0 {
            script.frames -= 1;
            return;
        }
        let mut stage = Stage { world, window };
        while let Some(line) = script.lines.pop_front() {
            match stage.perform(&mut script, &line) {
                Ok(Next::Line) => {}
                Ok(Next::Frame) => break,
                Ok(Next::Wait) => {
                    let since = *script.waiting_since.get_or_insert_with(Instant::now);
                    if since.elapsed() > PATIENCE {
                        stage.fail(&format!("`{line}` took longer than {} s", PATIENCE.as_secs()));
                    } else {
                        script.lines.push_front(line);
                    }
                    return;
                }
                Err(why) => return stage.fail(&format!("`{line}`: {why}")),
            }
            script.waiting_since = None;
        }
    });
}

enum Next {
    Line,
    Frame,
    Wait,
}

impl Stage<'_> {
    fn fail(&mut self, why: &str) {
        note(&format!("script: {why}"));
        self.world.write_message(AppExit::error());
    }

    fn sandbox(&mut self) -> Mut<'_, Sandbox> {
        self.world.resource_mut::<Sandbox>()
    }

    /// As the window would: once by its kind, for the view, and once among all its events, for the panels.
    fn send<M: Message + Clone + Into<WindowEvent>>(&mut self, message: M) {
        self.world.write_message(message.clone());
        self.world.write_message(message.into());
    }

    fn perform(&mut self, script: &mut Script, line: &str) -> Result<Next, String> {
        let (verb, rest) = line.split_once(' ').unwrap_or((line, ""));
        let words: Vec<&str> = rest.split_whitespace().collect();
        let number = |k: usize| -> Result<f32, String> {
            words.get(k).and_then(|w| w.parse().ok()).ok_or_else(|| format!("word {} must be a number", k + 1))
        };
        match verb {
            "wait" => return Ok(if self.has_come(rest)? { Next::Line } else { Next::Wait }),
            "frames" => {
                script.frames = number(0)? as u32;
                return Ok(Next::Frame);
            }
            "move" => self.move_to(script, Vec2::new(number(0)?, number(1)?)),
            "press" | "release" => self.button(verb == "press", words.first().copied()),
            "drag" => return self.drag(script, &words, &number),
            "wheel" => self.wheel(number(0)?),
            "key" => self.key(script, &words)?,
            "hold" => self.modifiers(&words, ButtonState::Pressed)?,
            "let-go" => self.modifiers(&words, ButtonState::Released)?,
            "open" => self.sandbox().wishes.push(Wish::OpenPath(rest.into())),
            "save" => self.sandbox().wishes.push(Wish::SaveTo(rest.into())),
            "mesh" => self.sandbox().wishes.push(Wish::Export(Asked::ExportMesh, rest.into())),
            "growth" => self.sandbox().wishes.push(Wish::Export(Asked::ExportGrowth, rest.into())),
            "report" => self.sandbox().wishes.push(Wish::Export(Asked::ExportReport, rest.into())),
            #[cfg(feature = "record")]
            "film" => self.film(&words, &number)?,
            // What still lacks a shader would lack in the picture.
            "shot" if !script.is_drawn.load(Ordering::Relaxed) => return Ok(Next::Wait),
            "shot" => self.sandbox().screenshots.push(rest.into()),
            "mode" => self.sandbox().choice.mode = mode(rest)?,
            "show" => self.show(rest)?,
            "lambda" => {
                let lambda = number(0)?;
                self.sandbox().choice.player.scrub(lambda);
            }
            "expect" => self.expect(rest)?,
            "resize" => {
                let size = (number(0)?, number(1)?);
                if let Some(mut window) = self.world.get_mut::<Window>(self.window) {
                    window.resolution.set(size.0, size.1);
                }
            }
            "quit" => drop(self.world.write_message(AppExit::Success)),
            _ => return Err("no such verb".into()),
        }
        Ok(if matches!(verb, "expect" | "mode" | "show" | "lambda") { Next::Line } else { Next::Frame })
    }

    fn has_come(&mut self, what: &str) -> Result<bool, String> {
        let is_waiting = self.world.get_resource::<Unhurried>().is_some_and(|unhurried| unhurried.is_waiting);
        let sandbox = self.world.resource::<Sandbox>();
        Ok(match what {
            "done" => sandbox.snapshot.phase == Phase::Done && !sandbox.awaits() && !is_waiting,
            "lattice" => sandbox.snapshot.lattice.is_some(),
            "busy" => sandbox.snapshot.phase.is_busy(),
            "idle" => sandbox.busy().is_none() && sandbox.wishes.is_empty(),
            #[cfg(feature = "record")]
            "preview" => sandbox.filming.as_ref().is_some_and(|film| film.preview().is_some()),
            #[cfg(feature = "record")]
            "film" => sandbox.filming.is_none() && sandbox.wishes.is_empty(),
            _ => return Err("wait for done, lattice, busy, idle, preview or film".into()),
        })
    }

    fn move_to(&mut self, script: &mut Script, position: Vec2) {
        script.pointer = position;
        self.send(CursorMoved { window: self.window, position, delta: None });
    }

    fn button(&mut self, pressed: bool, name: Option<&str>) {
        let button = match name {
            Some("right") => MouseButton::Right,
            Some("middle") => MouseButton::Middle,
            _ => MouseButton::Left,
        };
        let state = if pressed { ButtonState::Pressed } else { ButtonState::Released };
        self.send(MouseButtonInput { button, state, window: self.window });
    }

    /// Becomes moves with a press before and a release after, two frames each: panels need one to see the pointer come.
    fn drag(
        &mut self,
        script: &mut Script,
        words: &[&str],
        number: &dyn Fn(usize) -> Result<f32, String>,
    ) -> Result<Next, String> {
        let (from, to) = (Vec2::new(number(0)?, number(1)?), Vec2::new(number(2)?, number(3)?));
        let (steps, button) = (number(4)?.max(1.0) as u32, words.get(5).copied().unwrap_or("left"));
        let mut lines = vec![format!("move {} {}", from.x, from.y), "frames 1".into(), format!("press {button}")];
        for k in 1..=steps {
            let at = from.lerp(to, k as f32 / steps as f32);
            lines.push(format!("move {} {}", at.x, at.y));
        }
        lines.extend([format!("release {button}"), "frames 1".into()]);
        lines.into_iter().rev().for_each(|line| script.lines.push_front(line));
        Ok(Next::Line)
    }

    fn wheel(&mut self, y: f32) {
        self.send(MouseWheel {
            unit: MouseScrollUnit::Line,
            x: 0.0,
            y,
            window: self.window,
            phase: bevy::input::touch::TouchPhase::Moved,
        });
    }

    /// With modifiers it becomes several lines: they are held a frame before and let go a frame after.
    fn key(&mut self, script: &mut Script, words: &[&str]) -> Result<(), String> {
        let name = *words.first().ok_or("which key?")?;
        if let [_, modifiers @ ..] = words
            && !modifiers.is_empty()
        {
            let all = modifiers.join(" ");
            let lines = [format!("hold {all}"), format!("key {name}"), format!("let-go {all}")];
            lines.into_iter().rev().for_each(|line| script.lines.push_front(line));
            return Ok(());
        }
        let key = key(name)?;
        self.write_key(KeyCode::F24, &key, ButtonState::Pressed);
        self.write_key(KeyCode::F24, &key, ButtonState::Released);
        Ok(())
    }

    fn modifiers(&mut self, words: &[&str], state: ButtonState) -> Result<(), String> {
        for word in words {
            match *word {
                "ctrl" => self.write_key(KeyCode::ControlLeft, &Key::Control, state),
                "shift" => self.write_key(KeyCode::ShiftLeft, &Key::Shift, state),
                _ => return Err(format!("no modifier `{word}`")),
            }
        }
        Ok(())
    }

    fn write_key(&mut self, key_code: KeyCode, key: &Key, state: ButtonState) {
        self.send(KeyboardInput {
            key_code,
            logical_key: key.clone(),
            state,
            text: None,
            repeat: false,
            window: self.window,
        });
    }

    fn show(&mut self, what: &str) -> Result<(), String> {
        let choice = &mut self.sandbox().into_inner().choice;
        let toggled = |now: Compare, to: Compare| if now == to { Compare::Off } else { to };
        match what {
            "ghost" => choice.ghost = !choice.ghost,
            "sizes" => choice.size_legend = !choice.size_legend,
            "help" => choice.help = !choice.help,
            "gallery" => choice.gallery = !choice.gallery,
            "export" => choice.export.is_open = !choice.export.is_open,
            #[cfg(feature = "record")]
            "record" if choice.record.is_open => choice.record.is_open = false,
            #[cfg(feature = "record")]
            "record" => crate::panel::open_record(choice, "hand.ron"),
            "beside" => choice.compare = toggled(choice.compare, Compare::SideBySide),
            "wipe" => choice.compare = toggled(choice.compare, Compare::Wipe),
            _ => return Err("show ghost, sizes, help, gallery, export, record, beside or wipe".into()),
        }
        Ok(())
    }

    /// Records a film with the settings of the dialog, small.
    #[cfg(feature = "record")]
    fn film(&mut self, words: &[&str], number: &dyn Fn(usize) -> Result<f32, String>) -> Result<(), String> {
        let path = words.first().ok_or("record to where?")?;
        let (width, height, seconds, fps) = (number(1)?, number(2)?, number(3)?, number(4)?);
        let mut sandbox = self.sandbox();
        let draft = &mut sandbox.choice.record.draft;
        (draft.width, draft.height) = (width as u32, height as u32);
        (draft.seconds, draft.fps, draft.hold) = (seconds.into(), fps as u32, 0.0);
        sandbox.wishes.push(Wish::Export(Asked::ExportFilm, path.into()));
        Ok(())
    }

    fn expect(&mut self, what: &str) -> Result<(), String> {
        let sandbox = self.world.resource::<Sandbox>();
        let (subject, value) = what.split_once(' ').unwrap_or((what, ""));
        let met = match subject {
            "problem" => sandbox.problem.as_ref().is_some_and(|problem| problem.contains(value)),
            "calm" => sandbox.problem.is_none(),
            "strokes" => {
                sandbox.open.as_ref().map(|open| open.painting.edits().len().to_string()) == Some(value.into())
            }
            "lambda" => {
                let wanted: f32 = value.parse().map_err(|_| "expect lambda NUMBER")?;
                (sandbox.choice.player.lambda() - wanted).abs() < 1e-3
            }
            "wipe" => {
                let wanted: f32 = value.parse().map_err(|_| "expect wipe NUMBER")?;
                (sandbox.choice.wipe - wanted).abs() < 0.02
            }
            _ => return Err("no such expectation".into()),
        };
        if met { Ok(()) } else { Err(format!("it is not so; the problem shown is {:?}", sandbox.problem)) }
    }
}

fn mode(name: &str) -> Result<Mode, String> {
    Ok(match name {
        "plain" => Mode::Plain,
        "importance" => Mode::Importance,
        "fidelity" => Mode::Fidelity,
        "voxels" => Mode::Voxels(VoxelColour::Importance),
        _ => return Err("no such mode".into()),
    })
}

fn key(name: &str) -> Result<Key, String> {
    Ok(match name {
        "space" => Key::Space,
        "left" => Key::ArrowLeft,
        "right" => Key::ArrowRight,
        "home" => Key::Home,
        "end" => Key::End,
        "escape" => Key::Escape,
        "f1" => Key::F1,
        "f12" => Key::F12,
        name if name.chars().count() == 1 => Key::Character(name.into()),
        _ => return Err("no such key".into()),
    })
}
