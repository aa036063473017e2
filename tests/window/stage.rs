//! The sandbox without a window, driven by Bevy's own input messages.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::mouse::{MouseButtonInput, MouseScrollUnit, MouseWheel};
use bevy::input::{ButtonState, InputPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::window::{CursorMoved, PrimaryWindow, WindowPlugin};
use homunculus::app::play::{PlayPlugin, Sandbox, Shown};
use homunculus::panel::Wish;
use homunculus::scene::{Draft, Scene, Source};
use homunculus::session::Phase;
use homunculus::view::{Orbit, Pose};

/// Longest wait for anything here; a fault, not a slow machine, is what reaches it.
pub const PATIENCE: Duration = Duration::from_secs(240);

/// The sandbox without a window.
pub struct Stage {
    pub app: App,
    pub window: Entity,
    pub folder: tempfile::TempDir,
}

impl Stage {
    pub fn empty() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, InputPlugin, WindowPlugin::default()))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(20)))
            .insert_resource(Sandbox::new(Some(folder.path().join("memory"))).unwrap())
            .add_plugins(PlayPlugin);
        app.finish();
        app.cleanup();
        app.update();
        let window = app.world_mut().query_filtered::<Entity, With<PrimaryWindow>>().single(app.world()).unwrap();
        Self { app, window, folder }
    }

    /// The hand at a low resolution, its lattice there.
    pub fn hand() -> Self {
        Self::of(|_| ())
    }

    /// The hand with something else about it.
    pub fn of(change: impl FnOnce(&mut Draft)) -> Self {
        let mut stage = Self::empty();
        let path = stage.path("hand.ron");
        let mut draft = Draft::of(Source::Gallery("hand".into()));
        (draft.resolution, draft.keys) = (20, 4);
        change(&mut draft);
        Scene::new(draft).unwrap().save(&path).unwrap();
        stage.wish(Wish::OpenPath(path));
        stage.wait("the lattice", |s| s.open.is_some() && s.snapshot.lattice.is_some());
        stage.app.update();
        stage
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn sandbox(&mut self) -> Mut<'_, Sandbox> {
        self.app.world_mut().resource_mut::<Sandbox>()
    }

    pub fn wish(&mut self, wish: Wish) {
        self.sandbox().wishes.push(wish);
        self.app.update();
    }

    pub fn wait(&mut self, what: &str, until: impl Fn(&Sandbox) -> bool) {
        let start = Instant::now();
        while !until(&self.sandbox()) {
            assert!(start.elapsed() < PATIENCE, "{what} did not come: {:?}", self.sandbox().problem);
            self.app.update();
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    pub fn solved(&mut self) {
        self.wait("the end of the solve", |s| s.snapshot.phase == Phase::Done && !s.awaits());
        self.app.update();
    }

    pub fn calm(&mut self) {
        self.wait("the end of the tasks", |s| s.busy().is_none() && s.wishes.is_empty());
        self.app.update();
    }

    pub fn move_to(&mut self, x: f32, y: f32) {
        let moved = CursorMoved { window: self.window, position: Vec2::new(x, y), delta: None };
        self.app.world_mut().write_message(moved);
        self.app.update();
    }

    pub fn button(&mut self, button: MouseButton, state: ButtonState) {
        self.app.world_mut().write_message(MouseButtonInput { button, state, window: self.window });
        self.app.update();
    }

    pub fn drag(&mut self, button: MouseButton, from: [f32; 2], to: [f32; 2]) {
        self.move_to(from[0], from[1]);
        self.button(button, ButtonState::Pressed);
        for k in 1..=6 {
            let t = k as f32 / 6.0;
            self.move_to(from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]));
        }
        self.button(button, ButtonState::Released);
    }

    pub fn wheel(&mut self, y: f32) {
        let unit = MouseScrollUnit::Line;
        let phase = bevy::input::touch::TouchPhase::Moved;
        self.app.world_mut().write_message(MouseWheel { unit, x: 0.0, y, window: self.window, phase });
        self.app.update();
    }

    pub fn write_key(&mut self, key_code: KeyCode, logical_key: Key, state: ButtonState) {
        let window = self.window;
        let message = KeyboardInput { key_code, logical_key, state, text: None, repeat: false, window };
        self.app.world_mut().write_message(message);
        self.app.update();
    }

    pub fn press(&mut self, key: Key) {
        self.write_key(KeyCode::F24, key.clone(), ButtonState::Pressed);
        self.write_key(KeyCode::F24, key, ButtonState::Released);
    }

    pub fn key(&mut self, character: &str) {
        self.press(Key::Character(character.into()));
    }

    pub fn control(&mut self, character: &str, shift: bool) {
        self.write_key(KeyCode::ControlLeft, Key::Control, ButtonState::Pressed);
        if shift {
            self.write_key(KeyCode::ShiftLeft, Key::Shift, ButtonState::Pressed);
        }
        self.key(character);
        if shift {
            self.write_key(KeyCode::ShiftLeft, Key::Shift, ButtonState::Released);
        }
        self.write_key(KeyCode::ControlLeft, Key::Control, ButtonState::Released);
    }

    pub fn orbit(&mut self) -> Orbit {
        *self.app.world_mut().query::<&Orbit>().single(self.app.world()).unwrap()
    }

    pub fn bits(&mut self) -> Vec<u64> {
        self.sandbox().open.as_ref().unwrap().painting.ln().iter().map(|ln| ln.to_bits()).collect()
    }

    /// λ of the pose that is shown.
    pub fn shown_lambda(&mut self) -> f32 {
        let pose =
            self.app.world_mut().query_filtered::<&Pose, With<Shown>>().single(self.app.world()).unwrap().clone();
        let film = &self.sandbox().snapshot.film;
        let lambda = |state: &Arc<Vec<glam::Vec3A>>| {
            film.iter().find(|key| Arc::ptr_eq(&key.positions, state)).expect("a state of the film").lambda
        };
        lambda(&pose.from) + pose.blend * (lambda(&pose.to) - lambda(&pose.from))
    }
}

/// The middle of the view, where the hand is.
pub const MIDDLE: [f32; 2] = [640.0, 360.0];

pub fn paint(stage: &mut Stage) {
    stage.key("b");
    stage.drag(MouseButton::Left, MIDDLE, [660.0, 360.0]);
}
