//! Numbers of the relief that a fluid's crust takes on, finer than its particles (sections 3.2 and 3.3): ropes and pieces.

use super::super::parameters::Parameters;
use super::heat::Rheology;
use super::parameters::Flow;
use crate::field;
use crate::measure::ParameterError;
use crate::measure::parameter::{Cost, Parameter, Range};

/// Columns of the crust's grid along a rope's and a piece's length, at least.
const COLUMNS_A_ROPE: f64 = 12.0;
const COLUMNS_A_PIECE: f64 = 6.0;
/// Along a distance of particles, over which one toe meets another.
const COLUMNS_A_SEAM: f64 = 4.0;
/// Along the three blocks that a jumbled piece is a heap of.
const COLUMNS_A_JUMBLED_PIECE: f64 = 12.0;
/// Most columns of the crust along one of the surface's.
const MOST_DETAIL: u32 = 32;

/// The crust, in the ranges of [`Crust::declared`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crust {
    /// Thickness of the skin that bunches up into ropes in metres, 0 to 1000; at 0 there are none.
    pub skin_m: f32,
    /// Length of the pieces that it breaks into in distances of particles, 1 to 1.5, at which one of the 27 cells around a place has the
    /// particle in the middle of its piece; at 0 it does not break.
    pub pieces: f32,
    /// Height by which pieces are raised and tilted over their length, 0 to 1.
    pub jumble: f32,
    /// Time in which new crust closes a gap between pieces, seconds, 0 to 1000.
    pub healing_s: f32,
}

impl Default for Crust {
    fn default() -> Self {
        Crust { skin_m: 0.0, pieces: 0.0, jumble: 0.0, healing_s: 1.0 }
    }
}

impl Crust {
    /// Every number that a user can set, once.
    pub fn declared() -> Vec<Parameter<Crust>> {
        vec![
            Parameter::new("skin", field!(Crust.skin_m))
                .range(Range::from(0.0).to(1000.0))
                .unit("metres")
                .help("With basalt: thickness of the skin that bunches up into ropes where the flow is halted; at 0 there are none")
                .section("3.2")
                .cost(Cost::Buffers),
            Parameter::new("pieces", field!(Crust.pieces))
                .range(Range::from(0.0).to(1.5))
                .help("With basalt: length of the pieces that the crust is torn into where the flow stretches, in distances of particles, 1 at least; at 0 it does not tear")
                .section("3.3")
                .cost(Cost::Buffers),
            Parameter::new("jumble", field!(Crust.jumble))
                .range(Range::from(0.0).to(1.0))
                .help("With pieces: height by which they are raised and tilted over their length, as the clinker of aa")
                .section("3.3")
                .cost(Cost::Buffers),
            Parameter::new("healing", field!(Crust.healing_s))
                .range(Range::from(0.0).to(1000.0))
                .unit("seconds")
                .help("With pieces: time in which new crust closes a gap between them")
                .section("3.3")
                .cost(Cost::Buffers),
        ]
    }

    /// Length of a rope along the skin in metres, over an inside so many times softer: of the folds that grow fastest of a layer whose viscosity
    /// falls exponentially with depth (Fink and Fletcher 1978), without weight. Their stability analysis fitted from 5 to 10,000 within 4 %.
    pub fn rope_m(&self, stiffness: f64) -> f64 {
        3.55 * f64::from(self.skin_m) * stiffness.powf(0.2)
    }

    /// True of a crust that has relief of its own.
    fn is_there(&self) -> bool {
        self.skin_m > 0.0 || self.pieces > 0.0
    }

    /// Length of a piece in metres, of particles so far apart.
    pub fn piece_m(&self, spacing_m: f64) -> f64 {
        f64::from(self.pieces) * spacing_m
    }

    /// Columns of the crust's grid for one of the surface's: none without relief of its own and seams between toes.
    pub fn detail(&self, parameters: &Parameters) -> Option<u32> {
        let seam_m =
            if parameters.flow.vent.toe_m3 > 0.0 { parameters.flow.spacing_m(parameters.particles) } else { 0.0 };
        let needed = [
            (seam_m, COLUMNS_A_SEAM),
            (self.rope_m(stiffness(&parameters.flow)), COLUMNS_A_ROPE),
            (
                self.piece_m(parameters.flow.spacing_m(parameters.particles)),
                if self.jumble > 0.0 { COLUMNS_A_JUMBLED_PIECE } else { COLUMNS_A_PIECE },
            ),
        ];
        let column_m = longest_column_m(parameters);
        let of = |(length_m, columns): (f64, f64)| (columns * column_m / length_m).ceil();
        needed.into_iter().filter(|(length_m, _)| *length_m > 0.0).map(of).reduce(f64::max).map(|detail| detail as u32)
    }

    /// Checks what ranges of single numbers do not.
    ///
    /// # Errors
    /// The first parameter that does not fit the others.
    pub fn check(&self, parameters: &Parameters) -> Result<(), ParameterError> {
        let heat = &parameters.flow.heat;
        let default = Crust::default();
        for (name, value) in [("skin", self.skin_m), ("pieces", self.pieces)] {
            let problem = "is of a crust, which only `rheology` basalt has";
            ParameterError::check(value == 0.0 || heat.rheology == Rheology::Basalt, name, value, problem)?;
        }
        for (name, value, unset) in
            [("jumble", self.jumble, default.jumble), ("healing", self.healing_s, default.healing_s)]
        {
            ParameterError::check(
                self.pieces > 0.0 || value == unset,
                name,
                value,
                "changes nothing without `pieces`",
            )?;
        }
        let is_grown = !(self.is_there() || parameters.flow.vent.toe_m3 > 0.0) || heat.solidus_k < heat.melt_k;
        ParameterError::check(
            is_grown,
            "solidus",
            heat.solidus_k,
            "must be below the `melt-temperature` for `skin`, `pieces` or `toe-volume`: crust grows between them",
        )?;
        let range = "must be 0, or 1 to 1.5 distances of particles";
        ParameterError::check(self.pieces == 0.0 || self.pieces >= 1.0, "pieces", self.pieces, range)?;
        let column_m = longest_column_m(parameters);
        let is_held = |alone: Crust| alone.detail(parameters).is_none_or(|detail| detail <= MOST_DETAIL);
        // Seams are as wide as particles lie apart.
        let problem = format!(
            "are too many for seams between toes on columns {column_m:.4} metres long, of which the crust has {MOST_DETAIL} times as \
             many at most: take a finer `density` or fewer"
        );
        let has_seams_alone = is_held(Crust { skin_m: 0.0, pieces: 0.0, ..*self });
        ParameterError::check(has_seams_alone, "particles", parameters.particles, &problem)?;
        let problem = format!(
            "is too fine for columns {column_m:.4} metres long, of which the crust has {MOST_DETAIL} times as many at most: take a finer \
             `density`"
        );
        let ropes = ("skin", self.skin_m, Crust { pieces: 0.0, ..*self });
        let pieces = ("pieces", self.pieces, Crust { skin_m: 0.0, ..*self });
        [ropes, pieces]
            .into_iter()
            .try_for_each(|(name, value, alone)| ParameterError::check(is_held(alone), name, value, &problem))
    }
}

/// Viscosity of the skin over that of the melt.
pub fn stiffness(flow: &Flow) -> f64 {
    flow.heat.stiffest(flow.viscosity_pa_s).max(1.0)
}

fn longest_column_m(parameters: &Parameters) -> f64 {
    let [columns, _, rows] = parameters.density.map(f64::from);
    let space_m = parameters.space_m.as_dvec3();
    (space_m.x / columns).max(space_m.z / rows)
}
