//! Loading tests: a specimen, a material and a machine in; curves, cracks and macroscopic quantities out.
//!
//! * [`piece`]: what a test needs to know of a specimen; [`material`]: microparameters by contact group; [`rig`]: the
//!   piece mounted with bonds in, free of force; [`platens`]: between two platens or jaws
//! * [`pace`]: a speed that adapts to the cracks
//! * [`kind`]: the tests and the responses that each declares; [`settings`], [`speed`]: how fast, when to sample and stop,
//!   in numbers of their own or relative to the piece
//! * [`drive`]: the loop all tests share; [`crack`], [`snapshot`]: what is noted on the way; [`gauge`]: lateral strain
//! * [`curve`]: strength, moduli, Poisson's ratio by name; [`judgement`]: is it quasi-static; [`validity`]: did the piece
//!   fail as the test supposes; [`record`]: all of it together
//! * [`uniaxial`], [`brazilian`], [`tension`], [`confined`], [`bending`]: the tests; [`run`] starts the one that is asked for
//!
//! Imports run one way: settings and loop know no test, a test knows settings and loop, `run` knows the tests.
//!
//! # What the published campaign leaves open, and what was settled
//! Su et al. 2021 (doi:10.3390/ma14071627). "Base" is the set held in its response surfaces with σ_c/τ_c = 20/20 MPa;
//! there five published runs give 41.3 ± 1.5 MPa, and the published surfaces 34.4 GPa and 0.243. Computed values are
//! single seeds at 0.02 to 0.04 m/s. R is the mean radius asked for.
//!
//! | open point | settled | evidence |
//! |---|---|---|
//! | N or mean radius | N of eq. (4) is kept, radii × 0.97 | text; unscaled radii would give porosity 0.066 |
//! | overlaps of the packing | reference gaps, nothing locked in | mortar alone, R = 1 mm: 42.6 MPa, coordination 4.61 |
//! | bond gap | none: bonds where discs overlap | 5 % of R adds 1 to 10 % strength and 3 % to E (R = 1.6 mm) |
//! | polygons | in the circle of their size, angles fully random (12.5 % of the area) | R = 0.5 mm: 34.6 GPa, 0.269; polygons of equal area (28.9 %): 42.0 GPa, 0.250 |
//! | E | tangent over 40 to 60 % of the peak | secant within 2 %, but for rows whose weak interface slides early |
//! | ν | strain ratio at half the peak, side gauges | tangent ratio within 0.01 for the same rows |
//! | masses | their own or of one time step: free choice | R = 1 mm: 42.55 against 42.63 MPa, E and ν equal to 3 digits, 1.8 times fewer steps |
//!
//! The bonds' angle of friction is zero, as the text has none. With 40° the trends of the computed strengths over the
//! published ones are within 2.1 standard errors for every factor (with 30° for all but two), and the scatter of their
//! ratio falls from 6.7 to 3.9 %, at the same level, E and ν: the likeliest cause (`workflows/c30/README.md`,
//! "Strength"). It stays at zero, the commercial code's default: an angle chosen for its results would be a fit. What
//! trend is left in E, −2.1 % over the range of E_c and +2.5 % over that of (E_c)_j, goes with the amount of interface:
//! two thirds of the aggregate turn both signs ("What is left in E").

pub mod bending;
pub mod brazilian;
pub mod confined;
pub mod crack;
pub mod curve;
pub mod drive;
pub mod fissure;
pub mod gauge;
pub mod judgement;
pub mod kind;
pub mod material;
pub mod pace;
pub mod piece;
pub mod platens;
pub mod record;
pub mod rig;
mod rollers;
pub mod run;
pub mod settings;
pub mod snapshot;
pub mod speed;
pub mod tension;
pub mod uniaxial;
pub mod validity;

#[cfg(test)]
mod tests;
