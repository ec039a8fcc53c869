//! Starts the test of each kind, on a piece whose outline suits it.

use super::judgement::LoadingWarning;
use super::kind::TestKind;
use super::material::Material;
use super::piece::{Outline, Piece};
use super::platens::between_platens;
use super::record::{TestRecord, Watcher};
use super::settings::{Loading, TestError};
use super::{bending, brazilian, confined, tension, uniaxial};
use crate::{Faults, Space};

impl Loading {
    /// Mounts the piece and runs the test to its end. `seed` draws bond strengths where they scatter; `watch` sees every
    /// sample, is asked again while a sample takes long, and may interrupt.
    ///
    /// # Errors
    /// All faults of the settings, an outline of the piece that does not suit the test, a test that would not end within
    /// its bound on steps, or what the engine finds wrong.
    pub fn run<S: Space>(
        &self,
        piece: &Piece<S>,
        material: &Material,
        seed: u64,
        watch: Watcher<'_>,
    ) -> Result<TestRecord<S>, TestError> {
        let faults = self.faults();
        if !faults.is_empty() {
            return Err(Faults(faults).into());
        }
        self.kind.suits(&piece.outline, S::DIMENSION)?;
        match self.kind {
            TestKind::Uniaxial => uniaxial::run(self, piece, material, seed, watch),
            TestKind::Brazilian => brazilian::run(self, piece, material, seed, watch),
            TestKind::Tension => tension::run(self, piece, material, seed, watch),
            TestKind::Biaxial | TestKind::Triaxial => confined::run(self, piece, material, seed, watch),
            TestKind::Bending => bending::run(self, piece, material, seed, watch),
        }
    }

    /// What should be known before the test is run: it costs a mounting, not a run.
    ///
    /// # Errors
    /// An outline that does not suit the test, a test that would not end within its bound on steps, or all faults of the
    /// input that the engine finds.
    pub fn warning<S: Space>(
        &self,
        piece: &Piece<S>,
        material: &Material,
    ) -> Result<Option<LoadingWarning>, TestError> {
        self.kind.suits(&piece.outline, S::DIMENSION)?;
        let (mounted, _) = between_platens(self, piece, material, 0)?;
        let schedule = self.schedule(&mounted.scales, &piece.outline, mounted.engine.time_step())?;
        Ok(LoadingWarning::of(schedule.speed, schedule.transits))
    }

    /// How the strain grows with the way of a platen, grip or roller: by the first number times the way over the second (m).
    pub(super) fn stretch(&self, outline: &Outline) -> (f64, f64) {
        let [width, height, _] = outline.extents();
        match self.kind {
            TestKind::Uniaxial | TestKind::Brazilian | TestKind::Biaxial | TestKind::Triaxial => (2.0, height),
            TestKind::Tension => (1.0, tension::half_free(height)),
            TestKind::Bending => {
                let span = bending::span(self, width);
                (6.0 * height, span * span)
            }
        }
    }
}

impl TestKind {
    /// Whether a piece of this outline, in 2 or 3 dimensions, can be put to this test.
    ///
    /// # Errors
    /// It cannot; the error says what the test needs.
    pub fn suits(self, outline: &Outline, dimension: usize) -> Result<(), TestError> {
        let solid = dimension == 3;
        let upright = !matches!(outline, Outline::Disc { .. });
        let block = if solid { "width, depth and height, or diameter and height" } else { "width and height" };
        let (fits, wanted, remedy) = match self {
            TestKind::Uniaxial | TestKind::Tension if solid => (upright, "box or standing cylinder", block),
            TestKind::Uniaxial | TestKind::Tension => (upright, "rectangle", block),
            TestKind::Brazilian if solid => (!upright, "lying cylinder", "a diameter and a depth"),
            TestKind::Brazilian => (!upright, "disc", "a diameter"),
            TestKind::Biaxial => {
                (upright && !solid, "rectangle (in the solid the test is `triaxial`)", "width and height")
            }
            TestKind::Triaxial => {
                (upright && solid, "box or standing cylinder (in the plane the test is `biaxial`)", block)
            }
            TestKind::Bending => (upright && !solid, "rectangle", "width and height"),
        };
        if fits {
            return Ok(());
        }
        let found = outline.name(dimension);
        Err(TestError::Outline { test: self.name(), wanted, found, remedy })
    }
}
