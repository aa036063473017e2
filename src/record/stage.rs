//! The studio with the actor in it: one picture for each frame of the plan.

use std::sync::Arc;

use bevy::prelude::*;
use image::RgbaImage;

use super::lens::{Lens, Sight};
use super::overlay::{Caption, Slate, Writing};
use super::wall::Wall;
use super::{Actor, FramePlan, Settings, View};
use crate::Result;
use crate::certificate::Certificate;
use crate::view::headless::{Renderer, Shown};
use crate::view::{Adapter, Backdrop, FIELD_OF_VIEW, Looks, Mode, Orbit, Placement, Quality, Studio, VoxelColour};

/// Directions that the camera is fitted to while it goes around.
const DIRECTIONS: usize = 16;

/// Space between two bodies side by side, as a part of their width.
const GAP: f32 = 0.12;

/// Pixels of a still up to which a software driver draws four for each: it takes seconds, once.
const FINE_PIXELS: u32 = 3840 * 2160;

/// Pixels of a film up to which four are drawn for each, too: those of a small animation on a web page, whose edges would
/// show their steps; a software driver draws one or two a second.
const FINE_FILM_PIXELS: u32 = 512 * 512;

/// What one frame shows was found to be.
#[derive(Debug, Clone, Default)]
pub(super) struct Findings {
    /// Of the growth, where it is shown.
    pub growth: Option<Certificate>,
    /// Of Eq. 1 alone, where it is shown.
    pub classic: Option<Certificate>,
    /// Triangles that are faulty there.
    pub faulty: Option<Arc<Vec<u32>>>,
}

/// A studio.
pub(super) struct Stage {
    renderer: Renderer,
    growth: Option<Entity>,
    classic: Option<Entity>,
    slate: Slate,
    lens: Lens,
    orbit: Orbit,
    /// Between the middles of two bodies, view units.
    apart: f32,
}

impl Stage {
    /// Sets it up for a film.
    pub fn new(actor: &Actor, settings: &Settings, plan: &[FramePlan], adapter: &Adapter) -> Result<Self> {
        let is_picture = actor.is_picture();
        let mut renderer = Renderer::new([settings.width, settings.height], quality(settings, adapter, is_picture))?;
        let looks = looks(actor, settings.view);
        let shown = |looks: &Looks| Shown { looks: looks.clone(), ..Shown::new(actor.body()) };
        let shows_classic = matches!(settings.view, View::Classic | View::Compare);
        // In grey, on which red tells.
        let classic = shows_classic.then(|| renderer.show(shown(&Looks::default())));
        let growth = (settings.view != View::Classic).then(|| renderer.show(shown(&looks)));
        let slate = Slate::new(Writing {
            title: settings.title.clone(),
            legend: looks.legend().filter(|_| settings.legend && growth.is_some()),
            captions: Vec::new(),
            on_paper: settings.transparent,
        });
        let backdrop = if settings.transparent { Backdrop::Transparent } else { Backdrop::Studio };
        renderer.world_mut().insert_resource(Studio { backdrop, floor: !is_picture });
        let on_screen = slate.clone();
        renderer.overlay(move |context| on_screen.draw(context));

        let orbit = Orbit {
            yaw: settings.camera.yaw.to_radians(),
            pitch: settings.camera.pitch.to_radians(),
            orthographic: is_picture,
            ..Orbit::default()
        };
        let (lens, apart) = fit(actor, settings, plan, &orbit);
        let lens = Lens { distance: lens.distance / settings.camera.zoom, ..lens };
        let mut stage = Self { renderer, growth, classic, slate, lens, orbit, apart };
        // Shaders, letters and textures come with the first picture, which is not shown.
        if let Some(first) = plan.first() {
            stage.picture(actor, first, &Findings::default())?;
        }
        Ok(stage)
    }

    /// The picture of a frame.
    pub fn picture(&mut self, actor: &Actor, frame: &FramePlan, findings: &Findings) -> Result<RgbaImage> {
        let orbit = Orbit {
            yaw: self.orbit.yaw + frame.turn,
            target: self.lens.target,
            distance: self.lens.distance,
            ..self.orbit
        };
        if let Some(mut camera) = self.renderer.orbit() {
            *camera = orbit;
        }
        // Side by side as the camera sees them, wherever it stands.
        let aside = orbit.rotation() * Vec3::X * (0.5 * self.apart);
        for (entity, pose, offset) in
            [(self.classic, actor.classic_pose(frame.lambda), -aside), (self.growth, actor.pose(frame.mix), aside)]
        {
            let Some(entity) = entity else { continue };
            self.renderer.pose(entity, pose);
            if self.apart > 0.0 {
                self.renderer.world_mut().entity_mut(entity).insert(Placement { offset });
            }
        }
        if let Some(classic) = self.classic {
            self.mark(classic, findings.faulty.clone());
            let mut captions = vec![caption("linear solution alone (Eq. 1)", findings.classic.as_ref())];
            if self.growth.is_some() {
                captions.push(caption("certified growth", findings.growth.as_ref()));
            }
            self.slate.caption(captions);
        }
        self.renderer.frame()
    }
}

impl Stage {
    /// Draws triangles red.
    fn mark(&mut self, body: Entity, faulty: Option<Arc<Vec<u32>>>) {
        if let Some(mut looks) = self.renderer.world_mut().get_mut::<Looks>(body)
            && looks.marked != faulty
        {
            looks.marked = faulty;
        }
    }
}

/// Films as fast as the adapter likes; a still may take its time, and a small film takes little. A picture costs little,
/// and its edges are smoothed by samples: what smooths edges found in the finished frame would blur what is drawn in it.
fn quality(settings: &Settings, adapter: &Adapter, is_picture: bool) -> Quality {
    let mut quality = Quality::for_adapter(adapter);
    if is_picture {
        quality.samples = quality.samples.max(4);
    }
    let fits = 2 * settings.width.max(settings.height) <= adapter.largest_side;
    let most = if settings.still.is_some() { FINE_PIXELS } else { FINE_FILM_PIXELS };
    let is_fine = fits && settings.width * settings.height <= most;
    if is_fine { Quality { supersampling: 2, ..quality } } else { quality }
}

fn looks(actor: &Actor, view: View) -> Looks {
    let (mode, voxels) = match view {
        // Beside itself a picture is best told by what it shows.
        View::Classic | View::Compare if actor.is_picture() => (Mode::Plain, None),
        View::Importance | View::Classic | View::Compare => (Mode::Importance, None),
        View::Plain => (Mode::Plain, None),
        View::Voxels => (Mode::Voxels(VoxelColour::Importance), Some(actor.node_importance().clone())),
    };
    Looks { mode, importance: Some(actor.importance().clone()), voxels, ..Looks::default() }
}

/// Where the camera stands, and how far apart two bodies are.
fn fit(actor: &Actor, settings: &Settings, plan: &[FramePlan], orbit: &Orbit) -> (Lens, f32) {
    if actor.is_picture() {
        return hang(actor, settings);
    }
    let every = plan.len().div_ceil(DIRECTIONS).max(1);
    let mut yaws: Vec<f32> = plan.iter().step_by(every).map(|frame| orbit.yaw + frame.turn).collect();
    yaws.dedup();
    if yaws.is_empty() {
        yaws.push(orbit.yaw);
    }
    let aspect = settings.width as f32 / settings.height as f32;
    let opening = FIELD_OF_VIEW;
    let sight = Sight { yaws: &yaws, pitch: orbit.pitch, opening, aspect };
    let [certified, classic] = actor.reach();
    match settings.view {
        View::Classic => (sight.fit(&classic), 0.0),
        View::Compare => {
            // Two bodies side by side are one in a picture of half the width.
            let both: Vec<Vec3> = certified.into_iter().chain(classic).collect();
            let half = Sight { aspect: 0.5 * aspect, ..sight };
            let lens = half.fit(&both);
            let fills = 2.0 * lens.distance * (0.5 * opening).tan() * 0.5 * aspect;
            let widest = yaws.iter().map(|&yaw| width(&both, yaw)).fold(0.0, f32::max);
            (lens, (widest * (1.0 + GAP)).min(fills))
        }
        _ => (sight.fit(&certified), 0.0),
    }
}

/// The same for a picture.
fn hang(actor: &Actor, settings: &Settings) -> (Lens, f32) {
    let [certified, classic] = actor.reach();
    let shown = match settings.view {
        View::Classic => classic,
        View::Compare => certified.into_iter().chain(classic).collect(),
        _ => certified,
    };
    let low = shown.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::NEG_ONE);
    let high = shown.into_iter().reduce(Vec3::max).unwrap_or(Vec3::ONE);
    let wall = Wall {
        size: [settings.width, settings.height],
        title: settings.title.is_some(),
        legend: settings.legend && looks(actor, settings.view).legend().is_some(),
        pictures: if settings.view == View::Compare { 2 } else { 1 },
    };
    wall.hang(low, high)
}

/// How wide points are from one direction.
fn width(points: &[Vec3], yaw: f32) -> f32 {
    let right = Quat::from_rotation_y(yaw) * Vec3::X;
    let (low, high) = points
        .iter()
        .map(|p| p.dot(right))
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low <= high { high - low } else { 0.0 }
}

fn caption(name: &str, found: Option<&Certificate>) -> Caption {
    let (finding, is_fault) = match found {
        Some(found) => {
            let crossings = found.crossings() + found.surface_crossings();
            let count = |n: usize, one: &str, more: &str| format!("{n} {}", if n == 1 { one } else { more });
            let inverted = count(found.inverted(), "inverted element", "inverted elements");
            let red = if found.certified() { "" } else { " (red)" };
            (format!("{inverted}, {}{red}", count(crossings, "crossing", "crossings")), !found.certified())
        }
        None => (String::new(), false),
    };
    Caption { name: name.into(), finding, is_fault }
}
