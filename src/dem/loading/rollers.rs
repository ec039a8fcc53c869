//! Rollers of a bending test: discs of the machine, a tenth of the height in radius, that do not turn, with the friction of the
//! platens. Two support the beam, the third comes down at the speed of the test.
//!
//! Each stands straight under (or over) the ball that it touches, and goes with it along x. On the flank of a ball it would push the
//! beam along: the thrust of two supports stiffened a beam of ten rows by 3.5 %. A roller that stood still would be left by its ball,
//! for a ball on top of a smooth disc is not stable. So the beam is free along x, as on the rollers of a laboratory.

use super::material::PLATEN;
use super::piece::Piece;
use crate::space::Tuple;
use crate::{Engine, Faults, Other, Particle, Space, Spin, Vector};

/// Radius of a roller over the height of the beam.
const RADIUS: f64 = 0.1;

/// The rollers: two supports and the one that loads.
pub(super) struct Rollers {
    seats: [Seat; 3],
    /// Number of balls of the beam: the rollers come after them.
    balls: usize,
    /// Time when they last followed (s).
    followed: f64,
}

/// Where a roller touches the beam.
struct Seat {
    /// The ball that it touches, unless there is none.
    ball: Option<usize>,
    /// Centre of the roller along x and y (m).
    place: [f64; 2],
}

impl Rollers {
    /// Rollers that touch the beam near three places along x, each from below (−1) or above (1); the third is the one that loads.
    pub(super) fn under<S: Space>(piece: &Piece<S>, places: [(f64, f64); 3]) -> Self {
        let seats = places.map(|(x, side)| seat(piece, x, side));
        Self { seats, balls: piece.radii.len(), followed: 0.0 }
    }

    /// Where the supports stand along x (m).
    pub(super) fn supports(&self) -> [f64; 2] {
        [0, 1].map(|k| self.seats[k].place[0])
    }

    /// Their bodies.
    pub(super) fn bodies<S: Space>(&self, piece: &Piece<S>) -> Vec<Particle<S>> {
        let radius = RADIUS * piece.outline.height();
        let body = |seat: &Seat| {
            let position = Vector::<S>::build(|k| seat.place.get(k).copied().unwrap_or(0.0));
            Particle::ball(position, radius, piece.density, PLATEN)
        };
        self.seats.iter().map(body).collect()
    }

    /// Sets the supports at rest, and the third roller down at `speed` (m/s).
    ///
    /// # Errors
    /// A speed that is not finite.
    pub(super) fn start<S: Space>(&mut self, engine: &mut Engine<S>, speed: f64) -> Result<(), Faults> {
        for (k, down) in [0.0, 0.0, speed].into_iter().enumerate() {
            let velocity = Vector::<S>::build(|axis| if axis == 1 { -down } else { 0.0 });
            engine.set_motion(self.balls + k, velocity, Spin::<S>::zero())?;
        }
        self.followed = engine.time();
        Ok(())
    }

    /// Sends each roller along x to where its ball is now, within the time since this was done last: it lags by that time. A ball
    /// that has left its roller by more than its radius is no longer followed.
    pub(super) fn follow<S: Space>(&mut self, engine: &mut Engine<S>) {
        let since = engine.time() - self.followed;
        if since <= 0.0 {
            return;
        }
        self.followed = engine.time();
        for (k, seat) in self.seats.iter().enumerate() {
            let (Some(ball), roller) = (seat.ball, self.balls + k) else { continue };
            let off = engine.position(ball).at(0) - engine.position(roller).at(0);
            let along = if off.abs() > engine.radius(ball) { 0.0 } else { off / since };
            let now = engine.velocity(roller);
            let velocity = Vector::<S>::build(|axis| if axis == 0 { along } else { now.at(axis) });
            // Numbers that are not finite end the run by themselves.
            let _ = engine.set_motion(roller, velocity, Spin::<S>::zero());
        }
    }

    /// Forces of the beam on them along y (N per metre of thickness), downwards positive.
    pub(super) fn forces<S: Space>(&self, engine: &Engine<S>) -> [f64; 3] {
        let mut forces = [0.0; 3];
        for contact in engine.contacts().filter(|contact| contact.active) {
            let Other::Particle(other) = contact.other else { continue };
            // The force acts on the first end.
            for (particle, sign) in [(contact.particle, 1.0), (other, -1.0)] {
                if let Some(force) = particle.checked_sub(self.balls).and_then(|roller| forces.get_mut(roller)) {
                    *force -= sign * contact.force().at(1);
                }
            }
        }
        forces
    }
}

/// The roller near `x` that touches the beam from below (`side` −1) or above (1), straight under or over the ball that it touches.
fn seat<S: Space>(piece: &Piece<S>, x: f64, side: f64) -> Seat {
    let height = piece.outline.height();
    let radius = RADIUS * height;
    // The ball that a roller at x touches first, and how far from the axis the centre of the roller is then.
    let touched = |x: f64| {
        let reach = |(i, (centre, r)): (usize, (&Vector<S>, &f64))| {
            let (across, reach) = (centre.at(0) - x, r + radius);
            (across.abs() < reach).then(|| (side * centre.at(1) + (reach * reach - across * across).sqrt(), i))
        };
        piece.centres.iter().zip(&piece.radii).enumerate().filter_map(reach).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let (mut x, mut found) = (x, touched(x));
    // Each move brings it to a ball that lies further out, so it comes to an end.
    while let Some((_, ball)) = found
        && piece.centres[ball].at(0) != x
    {
        x = piece.centres[ball].at(0);
        found = touched(x);
    }
    let away = found.map_or(0.5 * height + radius, |(away, _)| away);
    Seat { ball: found.map(|(_, ball)| ball), place: [x, side * away] }
}
