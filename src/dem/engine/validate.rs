//! Checks of a model: all faults at once.

use super::Model;
use crate::boundary::{Motion, MovingCell, Wall};
use crate::error::{Fault, Faults};
use crate::interaction::{Bond, BondStiffness, ContactTable, Division, FlatJoint, Interaction, Shares, Stiffness};
use crate::neighbour::pairs;
use crate::particle::Group;
use crate::space::{Space, Tuple, Vector, flat};
use math::text::Amount;
use std::collections::BTreeMap;

pub(super) const POSITIVE: &str = "a number above 0";
const NOT_NEGATIVE: &str = "0 or more";
pub(super) const FINITE: &str = "a finite number";
const WALLS_IN_CELL: &str = "number of walls in a periodic cell";

pub(super) fn ok(faults: Vec<Fault>) -> Result<(), Faults> {
    if faults.is_empty() { Ok(()) } else { Err(Faults(faults)) }
}

pub(super) fn positive(x: f64) -> bool {
    x > 0.0 && x.is_finite()
}

/// Checks a model.
pub(super) fn check<S: Space>(model: &Model<S>) -> Result<(), Faults> {
    let mut faults = Vec::new();
    let clump_of = clumps(model, &mut faults);
    particles(model, &clump_of, &mut faults);
    for (w, wall) in model.walls.iter().enumerate() {
        faults.extend(wall_faults(w, wall));
    }
    settings(model, &mut faults);
    cell(model, &mut faults);
    let members = model.particles.iter().map(|p| p.group).zip(clump_of.iter().copied());
    let meetings = meetings(members, model.walls.iter().map(|w| w.group));
    faults.extend(table_faults::<S>(&model.contacts, &meetings));
    if faults.is_empty() {
        overlaps(model, &clump_of, &mut faults);
        for (w, wall) in model.walls.iter().enumerate() {
            let balls = model.particles.iter().map(|p| (p.position, p.radius));
            faults.extend(wall_overlaps(w, wall, balls, model.settings.overlap_limit));
        }
    }
    ok(faults)
}

/// Checks a table against the pairs of groups that can meet.
pub(super) fn check_table<S: Space>(table: &ContactTable, meetings: &[(Group, Group)]) -> Result<(), Faults> {
    ok(table_faults::<S>(table, meetings))
}

/// Checks one wall.
pub(super) fn check_wall<S: Space>(w: usize, wall: &Wall<S>, in_cell: bool) -> Result<(), Faults> {
    let mut faults = wall_faults(w, wall);
    faults.extend(in_cell.then_some(Fault::Setting {
        quantity: WALLS_IN_CELL,
        value: Amount::number(1.0),
        wanted: "none",
    }));
    ok(faults)
}

/// Checks the velocity gradient of a cell.
pub(super) fn check_rate(has_cell: bool, rate: &[[f64; 3]; 3]) -> Result<(), Faults> {
    let mut faults = rate_faults(rate);
    let value = Amount::number(0.0);
    faults.extend((!has_cell).then_some(Fault::Setting { quantity: "periodic cell", value, wanted: "one" }));
    ok(faults)
}

fn rate_faults(rate: &[[f64; 3]; 3]) -> Vec<Fault> {
    let bad = rate.iter().flatten().find(|x| !x.is_finite()).map(|&rate| Amount(rate, "1/s"));
    bad.map(|value| Fault::Setting { quantity: "rate of the cell", value, wanted: FINITE }).into_iter().collect()
}

/// A cell: large enough that no pair meets twice, all bodies inside, no walls.
fn cell<S: Space>(model: &Model<S>, faults: &mut Vec<Fault>) {
    let Some(cell) = &model.settings.cell else { return };
    let largest = model.particles.iter().map(|p| p.radius).fold(0.0, f64::max);
    for k in 0..S::DIMENSION {
        let (low, edge) = (cell.low.at(k), cell.edges.at(k));
        if !low.is_finite() {
            faults.push(Fault::Setting { quantity: "corner of the cell", value: Amount(low, "m"), wanted: FINITE });
        }
        faults.extend(cell_edge(edge, largest));
        let outside = |x: f64| !(x >= low && x <= low + edge);
        for (particle, p) in model.particles.iter().enumerate().filter(|(_, p)| outside(p.position.at(k))) {
            let value = Amount(p.position.at(k), "m");
            faults.push(Fault::Particle { particle, quantity: "position", value, wanted: "inside the cell" });
        }
    }
    faults.extend(rate_faults(&cell.rate));
    if !model.walls.is_empty() {
        let value = Amount::number(model.walls.len() as f64);
        faults.push(Fault::Setting { quantity: WALLS_IN_CELL, value, wanted: "none" });
    }
}

/// An edge on which a pair could meet twice.
pub(super) fn cell_edge(edge: f64, largest: f64) -> Option<Fault> {
    let wanted = "at least six times the largest radius";
    let good = edge >= 6.0 * largest && edge.is_finite();
    (!good).then_some(Fault::Setting { quantity: "edge of the cell", value: Amount(edge, "m"), wanted })
}

/// Pairs of groups that can meet: of different bodies, and of particles with walls.
pub(super) fn meetings(
    members: impl Iterator<Item = (Group, u32)>,
    walls: impl Iterator<Item = Group>,
) -> Vec<(Group, Group)> {
    // A group with two bodies or more can meet itself.
    let mut groups: BTreeMap<Group, (u32, bool)> = BTreeMap::new();
    for (group, body) in members {
        let entry = groups.entry(group).or_insert((body, false));
        entry.1 |= entry.0 != body;
    }
    let mut found = Vec::new();
    let list: Vec<(Group, bool)> = groups.iter().map(|(group, (_, many))| (*group, *many)).collect();
    for (k, &(a, many)) in list.iter().enumerate() {
        found.extend(many.then_some((a, a)));
        found.extend(list[k + 1..].iter().map(|&(b, _)| (a, b)));
    }
    for wall in walls {
        found.extend(list.iter().map(|&(a, _)| (a.min(wall), a.max(wall))));
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// Body of each particle (its clump, or a number of its own).
fn clumps<S: Space>(model: &Model<S>, faults: &mut Vec<Fault>) -> Vec<u32> {
    let n = model.particles.len();
    let mut body: Vec<Option<u32>> = vec![None; n];
    for (clump, c) in model.clumps.iter().enumerate() {
        let mut fault = |quantity, value, wanted| faults.push(Fault::Clump { clump, quantity, value, wanted });
        if c.pebbles.is_empty() {
            fault("number of pebbles", Amount::number(0.0), "at least 1");
        }
        if !positive(c.mass) {
            fault("mass", Amount(c.mass, "kg"), POSITIVE);
        }
        if S::inverse_inertia(&c.inertia).is_none() {
            fault("inertia", Amount(c.inertia[2][2], "kg*m^2"), "a positive definite tensor");
        }
        let sum = c.centre.norm() + c.velocity.norm() + c.spin.norm();
        if !sum.is_finite() {
            fault("position, velocity or spin", Amount::number(sum), FINITE);
        }
        for &pebble in &c.pebbles {
            let problem = match body.get(pebble) {
                None => "does not exist",
                Some(Some(_)) => "belongs to a clump already",
                Some(None) => {
                    body[pebble] = Some(clump as u32);
                    continue;
                }
            };
            faults.push(Fault::Pebble { clump, pebble, problem });
        }
    }
    let own = |(p, b): (usize, Option<u32>)| b.unwrap_or((model.clumps.len() + p) as u32);
    body.into_iter().enumerate().map(own).collect()
}

fn particles<S: Space>(model: &Model<S>, body: &[u32], faults: &mut Vec<Fault>) {
    for (particle, p) in model.particles.iter().enumerate() {
        let mut check = |quantity, value: Amount, good: bool, wanted| {
            if !good {
                faults.push(Fault::Particle { particle, quantity, value, wanted });
            }
        };
        for k in 0..S::DIMENSION {
            let (x, v) = (p.position.at(k), p.velocity.at(k));
            check("position", Amount(x, "m"), x.is_finite(), FINITE);
            check("velocity", Amount(v, "m/s"), v.is_finite(), FINITE);
        }
        check("spin", Amount(p.spin.norm(), "rad/s"), p.spin.norm().is_finite(), FINITE);
        check("radius", Amount(p.radius, "m"), positive(p.radius), POSITIVE);
        if body[particle] as usize >= model.clumps.len() {
            check("mass", Amount(p.mass, "kg"), positive(p.mass), POSITIVE);
            check("inertia", Amount(p.inertia, "kg*m^2"), positive(p.inertia), POSITIVE);
        }
    }
    if model.particles.is_empty() {
        faults.push(Fault::Setting {
            quantity: "number of particles",
            value: Amount::number(0.0),
            wanted: "at least 1",
        });
    }
}

fn wall_faults<S: Space>(wall: usize, w: &Wall<S>) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut check = |quantity, value: Amount, good: bool, wanted| {
        if !good {
            faults.push(Fault::Wall { wall, quantity, value, wanted });
        }
    };
    let length = w.normal.norm();
    check("point", Amount(w.point.norm(), "m"), w.point.norm().is_finite(), FINITE);
    check("length of the normal", Amount::number(length), positive(length), POSITIVE);
    faults.extend(motion_faults(wall, &w.motion));
    faults
}

/// Faults of how a wall moves.
pub(super) fn motion_faults<S: Space>(wall: usize, motion: &Motion<S>) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut check = |quantity, value: Amount, good: bool, wanted| {
        if !good {
            faults.push(Fault::Wall { wall, quantity, value, wanted });
        }
    };
    match motion {
        Motion::Velocity(v) => check("velocity", Amount(v.norm(), "m/s"), v.norm().is_finite(), FINITE),
        Motion::Servo(s) => {
            check("servo pressure", Amount(s.pressure, "Pa"), s.pressure.is_finite(), FINITE);
            check("servo area", Amount(s.area, "m^2"), positive(s.area), POSITIVE);
            let relaxation = Amount::number(s.relaxation);
            check("servo relaxation", relaxation, s.relaxation > 0.0 && s.relaxation <= 1.0, "in (0, 1]");
            check("servo speed limit", Amount(s.speed_limit, "m/s"), positive(s.speed_limit), POSITIVE);
        }
    }
    faults
}

/// Checks local damping.
pub(super) fn check_damping(alpha: f64) -> Result<(), Faults> {
    ok(damping_fault(alpha).into_iter().collect())
}

/// Checks a factor on all velocities.
pub(super) fn check_factor(factor: f64) -> Result<(), Faults> {
    let good = factor >= 0.0 && factor.is_finite();
    let value = Amount::number(factor);
    let fault = Fault::Setting { quantity: "factor on velocities", value, wanted: "0 or more" };
    ok((!good).then_some(fault).into_iter().collect())
}

fn damping_fault(alpha: f64) -> Option<Fault> {
    let good = (0.0..1.0).contains(&alpha);
    (!good).then_some(Fault::Setting { quantity: "damping", value: Amount::number(alpha), wanted: "in [0, 1)" })
}

fn settings<S: Space>(model: &Model<S>, faults: &mut Vec<Fault>) {
    let s = &model.settings;
    faults.extend(damping_fault(s.damping));
    let mut check = |quantity, value: Amount, good: bool, wanted| {
        if !good {
            faults.push(Fault::Setting { quantity, value, wanted });
        }
    };
    check("gravity", Amount(s.gravity.norm(), "m/s^2"), s.gravity.norm().is_finite(), FINITE);
    let safety = Amount::number(s.safety);
    check("safety factor of the time step", safety, s.safety > 0.0 && s.safety <= 1.0, "in (0, 1]");
    check("overlap limit", Amount::number(s.overlap_limit), s.overlap_limit >= 0.0, NOT_NEGATIVE);
    if let Some(dt) = s.fixed_step {
        check("time step", Amount(dt, "s"), positive(dt), POSITIVE);
    }
    for (low, high) in s.bounds.iter().flat_map(|[low, high]| (0..S::DIMENSION).map(|k| (low.at(k), high.at(k)))) {
        check("lower bound", Amount(low, "m"), !low.is_nan() && !(low >= high), "a number below the upper bound");
        check("upper bound", Amount(high, "m"), !high.is_nan(), "a number");
    }
}

fn table_faults<S: Space>(table: &ContactTable, meetings: &[(Group, Group)]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (a, b, interaction) in &table.entries {
        let mut check = |quantity, value: Amount, good: bool, wanted| {
            if !good {
                faults.push(Fault::Interaction { a: *a, b: *b, quantity, value, wanted });
            }
        };
        interaction_faults(interaction, S::DIMENSION, &mut check);
    }
    let missing = meetings.iter().filter(|(a, b)| table.class(*a, *b).is_none());
    faults.extend(missing.map(|&(a, b)| Fault::NoInteraction { a, b }));
    faults
}

/// Called with a quantity, its value, whether that is allowed, and the allowed range.
type Check<'a> = &'a mut dyn FnMut(&'static str, Amount, bool, &'static str);

fn cement_faults(stiffness: BondStiffness, check: Check<'_>) {
    match stiffness {
        BondStiffness::Modulus { modulus, ratio } => {
            check("bond modulus", Amount(modulus, "Pa"), positive(modulus), POSITIVE);
            check("bond kn/ks", Amount::number(ratio), positive(ratio), POSITIVE);
        }
        BondStiffness::PerArea { kn, ks } => {
            check("bond kn", Amount(kn, "Pa/m"), positive(kn), POSITIVE);
            check("bond ks", Amount(ks, "Pa/m"), ks >= 0.0 && ks.is_finite(), NOT_NEGATIVE);
        }
    }
}

fn angle(friction: f64, check: Check<'_>) {
    let acute = (0.0..std::f64::consts::FRAC_PI_2).contains(&friction);
    check("friction angle", Amount(friction, "rad"), acute, "in [0, π/2)");
}

fn radius_multiplier(factor: f64, check: Check<'_>) {
    check("radius multiplier", Amount::number(factor), positive(factor), POSITIVE);
}

/// Elements and shares of flat joints.
fn joint_faults(joint: &FlatJoint, dimension: usize, check: Check<'_>) {
    let Division { rings, sectors } = joint.division;
    let most = Division::MOST;
    let least = if dimension == 2 { 1 } else { 3 };
    let whole = |count: u32| Amount::number(f64::from(count));
    check("rings", whole(rings), (1..=most).contains(&rings), "from 1 to 32");
    check("sectors", whole(sectors), (least..=most).contains(&sectors), "from 1 (space: 3) to 32");
    let count = joint.division.count();
    check("elements", whole(count), count <= most, "at most 32");
    let Shares { gapped, slit, gap } = joint.shares;
    check("gapped share", Amount::number(gapped), (0.0..=1.0).contains(&gapped), "in [0, 1]");
    check("slit share", Amount::number(slit), (0.0..=1.0).contains(&slit), "in [0, 1]");
    check("gapped and slit share", Amount::number(gapped + slit), gapped + slit <= 1.0, "at most 1");
    check("gap", Amount(gap, "m"), gap >= 0.0 && gap.is_finite(), NOT_NEGATIVE);
}

/// All faults of fractures and of the joints that they have.
pub(super) fn check_joints<S: Space>(
    fractures: &[super::Fracture<S>],
    sets: &[crate::interaction::SmoothJoint],
) -> Result<(), Faults> {
    let mut faults = Vec::new();
    let mut check = |quantity, value: Amount, good: bool, wanted| {
        if !good {
            faults.push(Fault::Setting { quantity, value, wanted });
        }
    };
    for fracture in fractures {
        let (length, middle) = (fracture.normal.norm(), fracture.centre.norm());
        check("centre of a fracture", Amount(middle, "m"), middle.is_finite(), FINITE);
        check("normal of a fracture", Amount::number(length), positive(length), "a vector that is not zero");
        check("radius of a fracture", Amount(fracture.radius, "m"), fracture.radius > 0.0, POSITIVE);
        let set = Amount::number(fracture.set as f64);
        check("joint of a fracture", set, fracture.set < sets.len(), "the number of one that there is");
    }
    for set in sets {
        cement_faults(set.stiffness, &mut check);
        radius_multiplier(set.radius_multiplier, &mut check);
        check("friction", Amount::number(set.friction), set.friction >= 0.0 && set.friction.is_finite(), NOT_NEGATIVE);
        angle(set.dilation, &mut check);
        if let Some(bond) = set.bond {
            check("tensile strength", Amount(bond.tensile_strength, "Pa"), bond.tensile_strength > 0.0, POSITIVE);
            check("cohesion", Amount(bond.cohesion, "Pa"), bond.cohesion > 0.0, POSITIVE);
            angle(bond.friction_angle, &mut check);
        }
    }
    ok(faults)
}

fn interaction_faults(interaction: &Interaction, dimension: usize, check: Check<'_>) {
    let linear = &interaction.linear;
    match linear.stiffness {
        Stiffness::Modulus { modulus, ratio, .. } => {
            check("modulus", Amount(modulus, "Pa"), positive(modulus), POSITIVE);
            check("kn/ks", Amount::number(ratio), positive(ratio), POSITIVE);
        }
        Stiffness::Direct { kn, ks } => {
            check("kn", Amount(kn, "N/m"), positive(kn), POSITIVE);
            check("ks", Amount(ks, "N/m"), ks >= 0.0 && ks.is_finite(), NOT_NEGATIVE);
        }
    }
    let friction = linear.friction;
    check("friction", Amount::number(friction), friction >= 0.0 && friction.is_finite(), NOT_NEGATIVE);
    for beta in [linear.dashpot.normal, linear.dashpot.shear] {
        check("dashpot", Amount::number(beta), beta >= 0.0 && beta.is_finite(), NOT_NEGATIVE);
    }
    let (strengths, scatter) = match interaction.bond {
        Bond::None => return,
        Bond::Contact(b) => {
            ([("tensile strength", b.tensile_strength), ("shear strength", b.shear_strength)], b.scatter)
        }
        Bond::Parallel(b) => {
            cement_faults(b.stiffness, check);
            radius_multiplier(b.radius_multiplier, check);
            check(
                "moment factor",
                Amount::number(b.moment_factor),
                (0.0..=1.0).contains(&b.moment_factor),
                "in [0, 1]",
            );
            angle(b.friction_angle, check);
            ([("tensile strength", b.tensile_strength), ("cohesion", b.cohesion)], b.scatter)
        }
        Bond::Flat(b) => {
            cement_faults(b.stiffness, check);
            radius_multiplier(b.radius_multiplier, check);
            angle(b.friction_angle, check);
            joint_faults(&b, dimension, check);
            ([("tensile strength", b.tensile_strength), ("cohesion", b.cohesion)], b.scatter)
        }
    };
    for (name, value) in strengths {
        check(name, Amount(value, "Pa"), value > 0.0, POSITIVE);
    }
    for (name, value) in [("tensile deviation", scatter.tensile), ("shear deviation", scatter.shear)] {
        check(name, Amount::number(value), value >= 0.0 && value.is_finite(), NOT_NEGATIVE);
    }
}

/// Starts too deep in one another, or with one centre, also across the faces of a cell.
fn overlaps<S: Space>(model: &Model<S>, body: &[u32], faults: &mut Vec<Fault>) {
    let mut centres: Vec<Vector<S>> = model.particles.iter().map(|p| p.position).collect();
    let mut origins: Vec<usize> = (0..centres.len()).collect();
    if let Some(cell) = model.settings.cell.as_ref().map(MovingCell::new) {
        let largest = model.particles.iter().map(|p| p.radius).fold(0.0, f64::max);
        for (p, _, centre) in cell.images_near(&centres, 2.0 * largest) {
            origins.push(p);
            centres.push(centre);
        }
    }
    let flat: Vec<[f64; 3]> = centres.iter().map(|&x| flat::<S>(x)).collect();
    let radii: Vec<f64> = origins.iter().map(|&p| model.particles[p].radius).collect();
    let bodies: Vec<u32> = origins.iter().map(|&p| body[p]).collect();
    let n = model.particles.len();
    pairs(&flat, &radii, &bodies, 0.0, |i, j| {
        let [i, j] = [i, j].map(|k| k as usize);
        let (a, b) = (origins[i], origins[j]);
        // Across a face each pair is found from both sides; two images meet as their bodies do.
        if i >= n || (j >= n && a > b) {
            return;
        }
        let distance = centres[j].minus(centres[i]).norm();
        // A clump is rigid however small its pebbles are: of a ball and a pebble the ball says what is deep.
        let size = match [i, j].map(|k| (bodies[k] as usize) < model.clumps.len()) {
            [true, false] => radii[j],
            [false, true] => radii[i],
            _ => radii[i].min(radii[j]),
        };
        let overlap = (radii[i] + radii[j] - distance) / size;
        if overlap > model.settings.overlap_limit || distance == 0.0 {
            faults.push(Fault::Overlap { a, b, overlap });
        }
    });
}

/// Balls, by position and radius, that start too deep in a wall.
pub(super) fn wall_overlaps<S: Space>(
    wall: usize,
    face: &Wall<S>,
    balls: impl Iterator<Item = (Vector<S>, f64)>,
    limit: f64,
) -> Vec<Fault> {
    let normal = face.normal.times(1.0 / face.normal.norm());
    let depth = |(x, radius): (Vector<S>, f64)| 1.0 - x.minus(face.point).dot(normal) / radius;
    let deep = balls.map(depth).enumerate().filter(|&(_, overlap)| overlap > limit);
    deep.map(|(particle, overlap)| Fault::InWall { wall, particle, overlap }).collect()
}
