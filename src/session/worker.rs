//! The solver's thread: takes orders, solves, publishes.

use std::{
    sync::{Arc, mpsc},
    time::{Duration, Instant},
};

use super::{Histogram, Lattice, Order, Phase, Shared, Snapshot, State};
use crate::{
    Error, Result,
    collision::plugin::{CollisionProblem, Resumed, Start, Warped},
    edge::plugin::LinearSolution,
    film::plugin::Reel,
    importance::plugin::Importance,
    run::{Domain, Run, domain_summary},
    schedule::Stage,
    settings::Settings,
    subject::Subject,
    transfer::plugin::Bound,
    voxel::plugin::{DomainBoundary, Lattice as Cells, SuspectedWelds},
};

/// Between two snapshots of a running solve: each shows a state, and a window draws no more than sixty a second.
const PUBLISH_EVERY: Duration = Duration::from_millis(40);

/// So long after the last dab the solve goes on: while a stroke is being made, the linear solution has the machine.
const QUIET: Duration = Duration::from_millis(200);

/// Works until told to end. Runs in a pool of its own that leaves one core to the window.
pub(super) fn work(inbox: &mpsc::Receiver<Order>, shared: &Shared) {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    // Where the system gives no threads the common pool does the work.
    let _pool = rayon::ThreadPoolBuilder::new().num_threads((cores - 1).max(1)).use_current_thread().build();
    let mut worker = Worker { shared, now: Snapshot::default(), task: None, job: None, published: Instant::now() };
    loop {
        let order = match worker.patience() {
            None => inbox.recv().ok(),
            Some(time) => match inbox.recv_timeout(time) {
                Err(mpsc::RecvTimeoutError::Timeout) => {
                    worker.guarded(Worker::advance);
                    continue;
                }
                order => order.ok(),
            },
        };
        let Some(order) = order else { return };
        let orders = newest(order, inbox);
        if worker.guarded(|worker| worker.obey(orders)) == Some(false) {
            return;
        }
    }
}

/// Of orders that wait only the newest of a kind counts, as each replaces the one before.
fn newest(first: Order, inbox: &mpsc::Receiver<Order>) -> Vec<Order> {
    let mut orders: Vec<Order> = Vec::new();
    for order in std::iter::once(first).chain(inbox.try_iter()) {
        if matches!(order, Order::Open(..)) {
            orders.clear();
        }
        orders.retain(|o| std::mem::discriminant(o) != std::mem::discriminant(&order));
        orders.push(order);
    }
    orders
}

/// What to solve, and how.
#[derive(Clone)]
struct Task {
    subject: Arc<dyn Subject>,
    settings: Settings,
}

/// What there is of a subject.
enum Job {
    Voxelize,
    Solve(Box<Solve>),
}

struct Solve {
    run: Run,
    /// Something else is asked for; when growth may begin with it.
    changed: Option<Instant>,
    /// Which phase was stopped.
    stopped: Option<Phase>,
}

struct Worker<'a> {
    shared: &'a Shared,
    now: Snapshot,
    task: Option<Task>,
    job: Option<Job>,
    published: Instant,
}

impl Worker<'_> {
    /// How long to wait for orders before going on; `None` for ever.
    fn patience(&self) -> Option<Duration> {
        if !self.now.phase.is_busy() {
            return None;
        }
        match self.job.as_ref()? {
            Job::Solve(solve) => {
                Some(solve.changed.map_or(Duration::ZERO, |at| at.saturating_duration_since(Instant::now())))
            }
            Job::Voxelize => Some(Duration::ZERO),
        }
    }

    /// Does something; a panic is a failure of what is being solved, and the solver waits for other orders.
    fn guarded<R>(&mut self, work: impl FnOnce(&mut Self) -> R) -> Option<R> {
        // What may be half-changed is given up below.
        let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| work(self)));
        if done.is_err() {
            self.note(Err(Error::Fault("the solver broke off".into())));
        }
        done.ok()
    }

    fn publish(&mut self) {
        self.now.version += 1;
        self.published = Instant::now();
        self.shared.publish(self.now.clone());
    }

    /// False when told to end.
    fn obey(&mut self, orders: Vec<Order>) -> bool {
        for order in orders {
            let result = match order {
                Order::Shutdown => return false,
                Order::Open(subject, settings, number) => {
                    (self.now.opened, self.now.answers) = (number, number);
                    self.open(Task { subject, settings })
                }
                Order::Importance(subject, at, number) => {
                    self.now.answers = number;
                    self.set_importance(subject, Some(at))
                }
                Order::Settings(settings, number) => {
                    self.now.answers = number;
                    self.set_settings(settings)
                }
                Order::Cancel => {
                    self.stop();
                    Ok(())
                }
                Order::Resume => {
                    self.resume();
                    Ok(())
                }
            };
            self.note(result);
        }
        // Who waits for an answer hears of those, too, that change nothing yet.
        if self.shared.latest().answers != self.now.answers {
            self.publish();
        }
        true
    }

    fn note(&mut self, result: Result<()>) {
        if let Err(error) = result {
            self.now.phase = Phase::Failed;
            self.now.error = Some(error.to_string());
            self.job = None;
            self.publish();
        }
    }

    fn open(&mut self, task: Task) -> Result<()> {
        let Snapshot { version, opened, answers, .. } = self.now;
        self.now = Snapshot { version, opened, answers, phase: Phase::Preparing, ..Snapshot::default() };
        task.domain().check()?;
        self.task = Some(task);
        self.job = Some(Job::Voxelize);
        self.publish();
        Ok(())
    }

    fn set_settings(&mut self, settings: Settings) -> Result<()> {
        let Some(task) = &mut self.task else { return Ok(()) };
        let same_lattice = task.settings.resolution == settings.resolution && self.now.phase != Phase::Failed;
        task.settings = settings.clone();
        let task = task.clone();
        match &mut self.job {
            Some(Job::Solve(solve)) if same_lattice => solve.run.set(settings, Start::Present),
            Some(Job::Voxelize) if same_lattice => return Ok(()),
            _ => return self.open(task),
        }
        self.changed(None)
    }

    /// The linear solution now; the rest once no more dabs come. `at` is when the change was ordered.
    fn set_importance(&mut self, subject: Arc<dyn Subject>, at: Option<Instant>) -> Result<()> {
        let Some(task) = &mut self.task else { return Ok(()) };
        task.subject = subject;
        match &mut self.job {
            Some(Job::Solve(solve)) => solve.run.ask(task.subject.content(), Start::Present),
            // What is being prepared takes it into account.
            Some(Job::Voxelize) => return Ok(()),
            // What has failed is tried again with it.
            None => {
                let task = task.clone();
                return self.open(task);
            }
        }
        self.changed(at)
    }

    /// Answers a change with the linear solution.
    fn changed(&mut self, at: Option<Instant>) -> Result<()> {
        let Some(Job::Solve(solve)) = &mut self.job else { return Ok(()) };
        solve.run.step_until(Stage::EdgeSolve)?;
        solve.changed = Some(Instant::now() + QUIET);
        solve.stopped = None;
        self.now.take_linear(&solve.run);
        self.now.phase = Phase::Adapting;
        self.now.fraction = 0.0;
        self.now.film_is_current = false;
        self.now.warped = None;
        self.now.certificate = None;
        self.now.outcome = None;
        self.now.dabs += 1;
        self.now.dab_milliseconds = at.map(|at| at.elapsed().as_secs_f64() * 1e3).or(self.now.dab_milliseconds);
        self.publish();
        Ok(())
    }

    fn stop(&mut self) {
        if !self.now.phase.is_busy() {
            return;
        }
        if let Some(Job::Solve(solve)) = &mut self.job {
            solve.stopped = Some(self.now.phase);
        }
        self.now.phase = Phase::Stopped;
        self.publish();
    }

    fn resume(&mut self) {
        if self.now.phase != Phase::Stopped {
            return;
        }
        match &mut self.job {
            Some(Job::Solve(solve)) => {
                self.now.phase = solve.stopped.take().unwrap_or(Phase::Growing);
            }
            Some(Job::Voxelize) => self.now.phase = Phase::Preparing,
            None => return,
        }
        self.publish();
    }

    /// The next piece of work.
    fn advance(&mut self) {
        let result = match &self.job {
            None => Ok(()),
            Some(Job::Voxelize) => self.prepare(),
            Some(Job::Solve(_)) if self.now.phase == Phase::Checking => self.finish(),
            Some(Job::Solve(_)) => self.iterate(),
        };
        self.note(result);
    }

    /// Lattice, importance, linear solution.
    fn prepare(&mut self) -> Result<()> {
        let Some(task) = self.task.clone() else { return Ok(()) };
        let mut run = Run::interactive(task.domain())?;
        run.step_until(Stage::Bind)?;
        self.now.lattice = Some(lattice(&task, &run)?);
        self.publish();

        run.step_until(Stage::EdgeSolve)?;
        self.now.take_linear(&run);
        self.now.phase = Phase::Growing;
        self.publish();

        self.job = Some(Job::Solve(Box::new(Solve { run, changed: None, stopped: None })));
        Ok(())
    }

    fn iterate(&mut self) -> Result<()> {
        let Some(Job::Solve(solve)) = &mut self.job else { return Ok(()) };
        let done = solve.run.step()?;
        if solve.changed.take().is_some() {
            let from_present = solve.run.get::<Resumed>().is_some();
            self.now.phase = if from_present { Phase::Adapting } else { Phase::Growing };
        }
        let progress = solve.run.progress();
        let adapting = self.now.phase == Phase::Adapting;
        self.now.fraction = progress.fraction;
        self.now.lambda = if adapting { 1.0 } else { progress.lambda };
        if progress.size_error_p95.is_finite() {
            self.now.size_error_p95 = Some(f64::from(progress.size_error_p95));
        }
        let has_key = self.take_film(adapting);
        if let (true, Some(Job::Solve(solve))) = (has_key, &self.job) {
            follow(&solve.run, &mut self.now);
        }
        if done {
            if adapting {
                self.grow_again();
            } else {
                self.now.phase = Phase::Checking;
            }
            self.take_state(true);
            self.publish();
        } else if has_key || self.published.elapsed() >= PUBLISH_EVERY {
            self.take_state(has_key);
            self.publish();
        }
        Ok(())
    }

    /// After the last valid state has been led to what is painted: the film.
    fn grow_again(&mut self) {
        self.take_state(true);
        if let Some(Job::Solve(solve)) = &mut self.job {
            solve.run.begin(Start::Rest);
            self.now.phase = Phase::Growing;
        }
    }

    /// The present state; with its histogram where it is one of the film.
    fn take_state(&mut self, with_histogram: bool) {
        let (Some(Job::Solve(solve)), Some(lattice)) = (&self.job, &self.now.lattice) else { return };
        let (Some(Warped(warped)), Some(CollisionProblem(problem))) = (solve.run.get(), solve.run.get()) else {
            return;
        };
        // While the film is solved again, what is shown is the state that was led to the new sizes.
        let keeps_adapted = self.now.phase == Phase::Growing && !self.now.film.is_empty() && !self.now.film_is_current;
        if keeps_adapted && self.now.warped.is_some() {
            return;
        }
        if with_histogram {
            let histogram = Histogram::new(&lattice.complex, &problem.importance, warped);
            self.now.histogram = Some(Arc::new(histogram));
            self.now.reached = Some(Arc::new(lattice.reached(&problem.importance, warped)));
        }
        self.now.warped = Some(Arc::new(warped.clone()));
        self.now.seconds = solve.run.seconds();
    }

    /// Keyframes that are new. A film of the importance before stays until the new one is whole.
    fn take_film(&mut self, adapting: bool) -> bool {
        let Some(Job::Solve(solve)) = &self.job else { return false };
        let Some(Reel(film)) = solve.run.get() else { return false };
        let keyframes = film.keyframes();
        if adapting {
            self.now.certificate = keyframes.last().map(|k| k.certificate.clone());
            return false;
        }
        let replaces = self.now.film.is_empty() || self.now.film_is_current;
        if !replaces || keyframes.len() <= self.now.film.len() {
            return false;
        }
        self.now.film_is_current = true;
        self.now.film.extend(keyframes[self.now.film.len()..].iter().map(State::of));
        self.now.certificate = keyframes.last().map(|k| k.certificate.clone());
        true
    }

    fn finish(&mut self) -> Result<()> {
        let Some(Job::Solve(solve)) = &mut self.job else { return Ok(()) };
        let outcome = solve.run.outcome()?;
        if let Some(Reel(film)) = solve.run.get() {
            self.now.film = film.keyframes().iter().map(State::of).collect();
        }
        follow(&solve.run, &mut self.now);
        self.now.film_is_current = true;
        self.now.warped = self.now.film.last().map(|state| state.positions.clone());
        self.now.certificate = Some(outcome.certificate.clone());
        self.now.size_error_p95 = Some(outcome.fidelity.p95);
        self.now.seconds = outcome.seconds.clone();
        if let (Some(lattice), Some(warped), Some(CollisionProblem(problem))) =
            (&self.now.lattice, &self.now.warped, solve.run.get())
        {
            self.now.histogram = Some(Arc::new(Histogram::new(&lattice.complex, &problem.importance, warped)));
            self.now.reached = Some(Arc::new(lattice.reached(&problem.importance, warped)));
        }
        self.now.outcome = Some(Arc::new(outcome));
        (self.now.phase, self.now.fraction, self.now.lambda) = (Phase::Done, 1.0, 1.0);
        self.publish();
        Ok(())
    }
}

impl Snapshot {
    /// V' and the importance it is for.
    fn take_linear(&mut self, run: &Run) {
        self.linear = run.get::<LinearSolution>().map(|linear| Arc::new(linear.0.clone()));
        self.importance = run.get::<Importance>().map(|importance| Arc::new(importance.nodes.clone()));
    }
}

impl State {
    fn of(keyframe: &crate::film::Keyframe) -> Self {
        Self {
            lambda: keyframe.lambda,
            positions: Arc::new(keyframe.positions.clone()),
            certificate: keyframe.certificate.clone(),
        }
    }
}

/// The surface of a picture may follow its nodes otherwise than at first: as the keyframes found so far have to be drawn.
fn follow(run: &Run, now: &mut Snapshot) {
    if let (Some(lattice), Some(Bound(binding))) = (&mut now.lattice, run.get()) {
        lattice.binding = binding.clone();
    }
}

impl Task {
    /// As the engine takes it.
    fn domain(&self) -> Domain {
        Domain { content: self.subject.content(), settings: self.settings.clone() }
    }
}

/// The lattice of a subject that is bound to it.
fn lattice(task: &Task, run: &Run) -> Result<Lattice> {
    let parts = (|| {
        Some((run.get::<DomainBoundary>()?, run.get::<Cells>()?, run.get::<Bound>()?, run.get::<SuspectedWelds>()?))
    })();
    let Some((DomainBoundary(boundary), Cells(complex), Bound(binding), SuspectedWelds(welds))) = parts else {
        return Err(Error::Fault("a domain that was voxelized has no lattice".into()));
    };
    let boundary = task.subject.drawn(boundary)?;
    let summary = domain_summary(complex, task.settings.resolution, *welds);
    Ok(Lattice { boundary, complex: complex.clone(), binding: binding.clone(), summary })
}
