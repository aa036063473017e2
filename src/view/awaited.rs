//! States that are computed beside the frames.
//!
//! # Practice
//! A new state costs some ten milliseconds for 20,000 triangles: more than a frame has where a GPU draws. A window shows
//! what it showed until the new one is there; of several new ones only the newest is begun when the one before is done, so
//! that something is always on its way to the screen.

use std::sync::Arc;

use bevy::{
    prelude::*,
    tasks::{AsyncComputeTaskPool, Task, block_on, poll_once},
};
use glam::Vec3A;

use super::{Body, Pose, ViewFrame, drawn::Rows, state::Computed};

/// While it is there, new states are computed beside the frames, and what was shown stays until they are. Without it each
/// frame shows what it is told, however long that takes, as films need.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Unhurried {
    /// Whether something else is to be shown than what is; kept by the view.
    pub is_waiting: bool,
    /// How many states were shown so, of all bodies that are there; kept by the view.
    pub shown: u64,
}

/// A state and what is drawn of it.
type Finished = (Arc<Vec<Vec3A>>, Computed);

/// A pose whose states are being computed.
pub(super) struct Awaited {
    /// What will be shown.
    pub pose: Pose,
    task: Task<Vec<Finished>>,
}

impl Awaited {
    /// Begins with the states that are not known yet.
    pub fn begin(
        body: &Body,
        frame: ViewFrame,
        rows: &Arc<Rows>,
        pose: &Pose,
        is_known: impl Fn(&Arc<Vec<Vec3A>>) -> bool,
    ) -> Self {
        let mut states: Vec<Arc<Vec<Vec3A>>> =
            [&pose.from, &pose.to].into_iter().filter(|state| !is_known(state)).cloned().collect();
        states.dedup_by(|a, b| Arc::ptr_eq(a, b));
        let (body, rows) = (body.clone(), rows.clone());
        let work = move |state: Arc<Vec<Vec3A>>| {
            let computed = Computed::new(&body, &frame, &rows, &state);
            (state, computed)
        };
        let task = AsyncComputeTaskPool::get().spawn(async move { states.into_iter().map(work).collect() });
        Self { pose: pose.clone(), task }
    }

    /// What has come of it, once it is done.
    pub fn finished(&mut self) -> Option<Vec<Finished>> {
        block_on(poll_once(&mut self.task))
    }
}
