//! The scenes of the paper's Fig. 7, modelled here: one file each, and a table in `assets/gallery/models` that says how
//! important each region is and why.
//!
//! Lengths are metres of a model two metres long or so; Y is up, +Z the front.

pub mod airplane;
pub mod bike;
pub mod colon;
pub mod comic;
pub mod elephant;
pub mod flowers;
pub mod goalkeeper;
pub mod lamp;
pub mod robot;
pub mod shapes;

use crate::error::Result;
use crate::gallery::Model;
use crate::gallery::baked::from_glb;
use crate::gallery::human::read_values;
use shapes::Solid;

/// A scene of Fig. 7.
#[derive(Clone, Copy)]
pub struct Figure {
    /// Its name, and that of its files in `assets/gallery/models`.
    pub name: &'static str,
    /// One line for a list of scenes.
    pub one_line: &'static str,
    /// Where the importance comes from.
    pub reference: &'static str,
    /// Cells along the longest side at which it is shown: no gap of the model is narrower than two of them.
    pub resolution: u32,
    /// μ at which it is shown.
    pub fidelity: f32,
    /// Degrees to the side and from above from where it is best seen.
    pub camera: [f32; 2],
    /// Cells of the first net when it is baked, metres: smaller than half of its narrowest gap.
    pub cell: f32,
    /// Builds the implicit shape.
    pub solid: fn() -> Solid,
    /// `region,importance,...` as CSV.
    table: &'static str,
    glb: &'static [u8],
}

/// A scene with its files, which carry its name.
macro_rules! figure {
    ($module:ident, $one_line:expr, $reference:expr, $resolution:expr, $fidelity:expr, $camera:expr, $cell:expr) => {
        Figure {
            name: stringify!($module),
            one_line: $one_line,
            reference: $reference,
            resolution: $resolution,
            fidelity: $fidelity,
            camera: $camera,
            cell: $cell,
            solid: $module::solid,
            table: include_str!(concat!("../../../assets/gallery/models/", stringify!($module), ".csv")),
            glb: include_bytes!(concat!("../../../assets/gallery/models/", stringify!($module), ".glb")),
        }
    };
}

static FIGURES: [Figure; 9] = [
    figure!(
        airplane,
        "an airliner on approach, each part as large as it is loud: engines, landing gear, flaps",
        "ranking after Matthews 2002 and DLR; sizes estimated",
        96,
        0.8,
        [38.0, 14.0],
        0.008
    ),
    figure!(
        elephant,
        "an elephant, each part as large as its black-market price: tusks",
        "Martin and Vigne 2014; TRAFFIC",
        96,
        0.8,
        [52.0, 10.0],
        0.011
    ),
    figure!(
        colon,
        "a coiled gut, focus and context: a polyp and the stretch around it",
        "the idea after Wang, Lee and Tai 2008",
        96,
        0.8,
        [14.0, 6.0],
        0.010
    ),
    figure!(
        lamp,
        "a desk lamp, each part as large as it is hot: a bulb grows in its shade",
        "estimated temperatures",
        96,
        0.8,
        [20.0, 8.0],
        0.009
    ),
    figure!(
        robot,
        "a walking robot, each joint as large as its torque",
        "Asimov 1 documentation; arms estimated",
        96,
        0.8,
        [20.0, 8.0],
        0.008
    ),
    figure!(comic, "a comic character exaggerated: eyes, hands, feet", "a choice", 96, 0.8, [16.0, 6.0], 0.008),
    figure!(
        bike,
        "a bicycle, large where it touches its rider: saddle, grips, pedals",
        "estimated contact",
        128,
        0.8,
        [24.0, 10.0],
        0.0065
    ),
    figure!(
        goalkeeper,
        "a diving goalkeeper, each part as large as its risk of injury: hands, knees, shoulders",
        "ranking after Muracki et al. 2021 and Br J Sports Med 45(4):331",
        128,
        0.8,
        [10.0, 8.0],
        0.0075
    ),
    figure!(
        flowers,
        "lilies in a vase, large where the pollen is: anthers",
        "schematic",
        128,
        0.8,
        [20.0, 12.0],
        0.0065
    ),
];

/// All of them.
pub fn figures() -> &'static [Figure] {
    &FIGURES
}

impl Figure {
    /// The table's text: CSV with `#` comment lines that state the reason.
    pub fn table(&self) -> &'static str {
        self.table
    }

    /// `(region, importance)` in the table's order.
    ///
    /// # Errors
    /// As [`read_values`]; a shipped table has none (the tests read them all).
    pub fn values(&self) -> Result<Vec<(String, f64)>> {
        read_values(&format!("models/{}.csv", self.name), self.table)
    }

    /// The baked surface with its regions.
    ///
    /// # Errors
    /// A fault of this program when the baked asset is damaged.
    pub fn model(&self) -> Result<Model> {
        let mesh = from_glb(self.name, self.glb)?;
        let solid = (self.solid)();
        let names: Vec<String> = solid.region_names().map(Into::into).collect();
        Ok(super::label(self.name, &mesh, &names, |p| solid.memberships(p)))
    }
}
