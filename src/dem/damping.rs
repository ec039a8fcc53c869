//! Local damping: F − α |F| sign(v) for each component, with sign(0) = 0 (Cundall & Strack 1979).
//!
//! F is the unbalanced force with gravity. A rebound off an undamped spring has restitution √((1 − α)/(1 + α)).

/// The damped force.
#[inline(always)]
pub(crate) fn damped(force: f64, velocity: f64, alpha: f64) -> f64 {
    let drag = (alpha * force.abs()).copysign(velocity);
    force - if velocity == 0.0 { 0.0 } else { drag }
}
