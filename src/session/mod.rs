//! The solver beside a window: its own thread, its own world, states handed over as they come.
//!
//! # Theory
//! Eq. 1's matrix depends on the lattice alone, so after a dab only its right-hand side changes: the linear solution is
//! there within a few cycles of a multigrid hierarchy that is kept, from the solution of before: the stages up to
//! [`EdgeSolve`](crate::schedule::Stage::EdgeSolve) run at once, the others once no more dabs come. The
//! certified solve then goes on from the last valid state to the new sizes, and when it has come to rest the growth is
//! solved from rest again, so that the film shows what is painted.
//!
//! # Practice
//! A [`Session`] never blocks who asks it. Orders go in by a channel, of several waiting ones only the newest of a kind
//! counts; a [`Snapshot`] comes out, the latest one wins, its arrays are shared and never copied. Cancelling takes one
//! iteration. One core is left to the window.

mod snapshot;
mod worker;

pub use snapshot::{Histogram, Lattice, Phase, Snapshot, State};

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicU64, Ordering},
        mpsc,
    },
    time::Instant,
};

use crate::{settings::Settings, subject::Subject};

/// What the solver is told; what changes the result, with its number.
enum Order {
    Open(Arc<dyn Subject>, Settings, u64),
    Importance(Arc<dyn Subject>, Instant, u64),
    Settings(Settings, u64),
    Cancel,
    Resume,
    Shutdown,
}

/// A solver in the background. Dropping it ends its thread.
pub struct Session {
    orders: mpsc::Sender<Order>,
    shared: Arc<Shared>,
    /// Number of the change by which it was given its subject.
    opened: AtomicU64,
    /// How many orders that change the result.
    changes: AtomicU64,
}

/// What both sides see.
#[derive(Default)]
struct Shared {
    snapshot: Mutex<Arc<Snapshot>>,
}

impl Shared {
    /// The latest snapshot. A lock that was poisoned holds a whole snapshot all the same.
    fn latest(&self) -> Arc<Snapshot> {
        self.snapshot.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone()
    }

    fn publish(&self, snapshot: Snapshot) {
        *self.snapshot.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Arc::new(snapshot);
    }
}

impl Session {
    /// Starts the thread, which waits for a [`Subject`].
    ///
    /// # Errors
    /// A fault where the system gives no thread.
    pub fn start() -> crate::Result<Self> {
        let (orders, inbox) = mpsc::channel();
        let shared = Arc::new(Shared::default());
        let seen = shared.clone();
        std::thread::Builder::new()
            .name("solver".into())
            .spawn(move || worker::work(&inbox, &seen))
            .map_err(|e| crate::Error::Fault(format!("starting the solver's thread: {e}")))?;
        Ok(Self { orders, shared, opened: AtomicU64::new(0), changes: AtomicU64::new(0) })
    }

    /// Solves something else.
    pub fn open(&self, subject: Arc<dyn Subject>, settings: Settings) {
        self.opened.store(self.change(), Ordering::Relaxed);
        self.order(Order::Open(subject, settings, self.opened.load(Ordering::Relaxed)));
    }

    /// Goes on with the same subject as it is now, painted otherwise.
    pub fn set_importance(&self, subject: Arc<dyn Subject>) {
        self.order(Order::Importance(subject, Instant::now(), self.change()));
    }

    /// Solves with other settings.
    pub fn set_settings(&self, settings: Settings) {
        self.order(Order::Settings(settings, self.change()));
    }

    /// Stops solving within an iteration; what has been reached stays.
    pub fn cancel(&self) {
        self.order(Order::Cancel);
    }

    /// Solves what [`cancel`](Self::cancel) stopped, from the last valid state.
    pub fn resume(&self) {
        self.order(Order::Resume);
    }

    /// Where it is: cheap, never waits for the solver. Nothing of a subject before the one it was given last.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        let latest = self.shared.latest();
        if latest.opened == self.opened.load(Ordering::Relaxed) {
            return latest;
        }
        Arc::new(Snapshot { phase: Phase::Preparing, ..Snapshot::default() })
    }

    /// Whether a snapshot is of all that has been ordered.
    pub fn is_answered(&self, snapshot: &Snapshot) -> bool {
        snapshot.answers == self.changes.load(Ordering::Relaxed)
    }

    /// The number of the next change, from 1.
    fn change(&self) -> u64 {
        self.changes.fetch_add(1, Ordering::Relaxed) + 1
    }

    fn order(&self, order: Order) {
        // The thread ends only with the session.
        let _ = self.orders.send(order);
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // Not waited for: it ends after its iteration, and holds nothing that others need.
        self.order(Order::Shutdown);
    }
}
