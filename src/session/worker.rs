//! The solver's thread: takes orders, solves, publishes.

use std::{
    sync::{Arc, mpsc},
    time::{Duration, Instant},
};

use super::{Asked, Asking, Histogram, Lattice, Linear, Order, Phase, Shared, Snapshot, State, Subject};
use crate::{
    Error, Result,
    boundary::Boundary,
    certificate::Shell,
    collision::plugin::{CollisionProblem, Shells, Warped},
    edge::plugin::LinearSolution,
    film::plugin::Reel,
    importance::plugin::Importance,
    schedule::{Domain, Run, Settings, domain_summary},
    transfer::{Binding, flat_boundary},
    voxel::{
        self, Dimension, check_flat_resolution, check_resolution,
        plugin::{PixelShares, SuspectedWelds},
        suspected_welds, voxelize,
    },
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
    let mut worker = Worker { shared, now: Snapshot::default(), subject: None, job: None, published: Instant::now() };
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

/// What there is of a subject.
enum Job {
    Voxelize,
    Solve(Box<Solve>),
}

struct Solve {
    run: Run,
    linear: Linear,
    /// Importance has changed and the run does not know yet; when it may be told.
    changed: Option<Instant>,
    asked: Asked,
    /// Which phase was stopped.
    stopped: Option<Phase>,
}

struct Worker<'a> {
    shared: &'a Shared,
    now: Snapshot,
    subject: Option<Subject>,
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
                Order::Open(subject, number) => {
                    (self.now.opened, self.now.answers) = (number, number);
                    self.open(subject)
                }
                Order::Importance(asking, at, number) => {
                    self.now.answers = number;
                    self.set_importance(asking, Some(at))
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

    fn open(&mut self, subject: Subject) -> Result<()> {
        let Snapshot { version, opened, answers, .. } = self.now;
        self.now = Snapshot { version, opened, answers, phase: Phase::Preparing, ..Snapshot::default() };
        match subject.picture {
            Some(_) => check_flat_resolution(subject.settings.resolution)?,
            None => check_resolution(subject.settings.resolution)?,
        }
        self.subject = Some(subject);
        self.job = Some(Job::Voxelize);
        self.publish();
        Ok(())
    }

    fn set_settings(&mut self, settings: Settings) -> Result<()> {
        let Some(subject) = &mut self.subject else { return Ok(()) };
        let same_lattice = subject.settings.resolution == settings.resolution && self.now.phase != Phase::Failed;
        subject.settings = settings;
        let subject = subject.clone();
        if same_lattice && self.job.is_some() {
            let picture = subject.picture.map(Asking::Picture);
            self.set_importance(picture.unwrap_or(Asking::Surface(subject.importance)), None)
        } else {
            self.open(subject)
        }
    }

    /// The linear solution now; the rest once no more dabs come. `at` is when the change was ordered.
    fn set_importance(&mut self, asking: Asking, at: Option<Instant>) -> Result<()> {
        let Some(subject) = &mut self.subject else { return Ok(()) };
        match asking {
            Asking::Surface(stack) => subject.importance = stack,
            Asking::Picture(picture) => subject.picture = Some(picture),
        }
        let (Some(Job::Solve(solve)), Some(lattice)) = (&mut self.job, &self.now.lattice) else {
            // What has failed is tried again with it; what is being prepared takes it into account.
            let subject = subject.clone();
            return if self.job.is_none() { self.open(subject) } else { Ok(()) };
        };
        let (asked, linear) = solve.linear.solve(subject, &lattice.complex);
        self.now.linear = Some(Arc::new(linear.to_vec()));
        self.now.importance = Some(Arc::new(asked.importance.nodes.clone()));
        solve.asked = asked;
        solve.changed = Some(Instant::now() + QUIET);
        solve.stopped = None;
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
            Some(Job::Solve(solve)) if solve.changed.is_some() => self.adapt(),
            Some(Job::Solve(_)) if self.now.phase == Phase::Checking => self.finish(),
            Some(Job::Solve(_)) => self.iterate(),
        };
        self.note(result);
    }

    /// Lattice, importance, linear solution.
    fn prepare(&mut self) -> Result<()> {
        let Some(subject) = self.subject.clone() else { return Ok(()) };
        let (lattice, welds) = lattice(&subject)?;
        let (boundary, complex) = (lattice.boundary.clone(), lattice.complex.clone());
        self.now.lattice = Some(lattice);
        self.publish();

        let mut linear = Linear::new(&subject, &complex);
        let (asked, solution) = linear.solve(&subject, &complex);
        let solution = solution.to_vec();
        self.now.linear = Some(Arc::new(solution.clone()));
        self.now.importance = Some(Arc::new(asked.importance.nodes.clone()));
        self.now.phase = Phase::Growing;
        self.publish();

        let mut run = Run::new(domain(&subject, &boundary, &asked))?;
        let parts = (asked.importance.clone(), LinearSolution(solution));
        run.insert((voxel::plugin::Lattice(complex), SuspectedWelds(welds), parts));
        if let Some((_, shares)) = &asked.pixels {
            run.insert(PixelShares(shares.clone()));
        }
        let solve = Solve { run, linear, changed: None, asked, stopped: None };
        self.job = Some(Job::Solve(Box::new(solve)));
        Ok(())
    }

    /// Tells the run what has changed: from the last valid state if there is one, else from rest.
    fn adapt(&mut self) -> Result<()> {
        let (Some(subject), Some(lattice), Some(Job::Solve(solve))) = (&self.subject, &self.now.lattice, &mut self.job)
        else {
            return Ok(());
        };
        let domain = domain(subject, &lattice.boundary, &solve.asked);
        solve.changed = None;
        if let Some((_, shares)) = &solve.asked.pixels {
            solve.run.insert(PixelShares(shares.clone()));
        }
        let (importance, linear) = solve.parts(self.now.linear.as_deref());
        if solve.run.go_on(domain.clone(), importance, linear) {
            self.now.phase = Phase::Adapting;
        } else {
            let (importance, linear) = solve.parts(self.now.linear.as_deref());
            solve.run.restart(domain, importance, linear);
            self.now.phase = Phase::Growing;
        }
        self.publish();
        Ok(())
    }

    fn iterate(&mut self) -> Result<()> {
        let Some(Job::Solve(solve)) = &mut self.job else { return Ok(()) };
        let done = solve.run.step()?;
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
        let (Some(subject), Some(lattice), Some(Job::Solve(solve))) = (&self.subject, &self.now.lattice, &mut self.job)
        else {
            return;
        };
        let (importance, linear) = solve.parts(self.now.linear.as_deref());
        let domain = domain(subject, &lattice.boundary, &solve.asked);
        solve.run.restart(domain, importance, linear);
        self.now.phase = Phase::Growing;
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

impl Solve {
    /// What a run needs to know of a change.
    fn parts(&self, linear: Option<&Vec<glam::Vec3A>>) -> (Importance, LinearSolution) {
        (self.asked.importance.clone(), LinearSolution(linear.cloned().unwrap_or_default()))
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
    let (Some(lattice), Some(Shells(shells))) = (&mut now.lattice, run.get()) else { return };
    if lattice.complex.dimension != Dimension::Two {
        return;
    }
    if let Some(binding) = shells.iter().find_map(Shell::binding)
        && !binding.follows_as(&lattice.binding)
    {
        lattice.binding = Arc::new(binding.clone());
    }
}

/// What is solved: the subject itself, or of a picture its pixels on the mesh they are drawn on.
fn domain(subject: &Subject, drawn: &Arc<Boundary>, asked: &Asked) -> Domain {
    let settings = subject.settings.clone();
    match &asked.pixels {
        Some((flat, _)) => Domain { boundary: drawn.clone(), ..Domain::picture(flat.clone(), settings) },
        None => Domain::body(subject.boundary.clone(), subject.importance.clone(), settings),
    }
}

/// The lattice of a subject, and how many of its cells are suspected of gluing sheets.
fn lattice(subject: &Subject) -> Result<(Lattice, usize)> {
    let resolution = subject.settings.resolution;
    let (boundary, complex, welds) = match &subject.picture {
        Some(picture) => {
            let flat = &picture.ground.flat;
            let complex = flat.lattice(resolution)?;
            let mesh = flat_boundary(&flat.name, &complex, flat.size);
            let mesh = mesh.with_texture(&flat.name, picture.ground.texture.to_vec());
            (Arc::new(mesh), complex, 0)
        }
        None => {
            let boundary = subject.boundary.clone();
            let complex = voxelize(&boundary, resolution)?;
            let welds = suspected_welds(&boundary, &boundary.welded(), &complex);
            (boundary, complex, welds)
        }
    };
    let summary = domain_summary(&complex, resolution, welds);
    let complex = Arc::new(complex);
    let binding = Arc::new(Binding::new(&boundary, &complex));
    Ok((Lattice { boundary, complex, binding, summary }, welds))
}
