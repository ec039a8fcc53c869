//! The kinds of artifact.

use std::fmt;

/// A kind of artifact: its name, the version of its layout, and what readers of any kind must know of it.
///
/// The set is open: a stage that gives something new declares a constant beside its own code, and everything that asks
/// (ports, printed tables, the report, exports) asks the constant. The kinds that several stages exchange stand here.
#[derive(Clone, Copy, Debug)]
pub struct ArtifactKind {
    name: &'static str,
    version: u32,
    main_table: Option<&'static str>,
}

impl ArtifactKind {
    /// A specimen: discs in a vessel, with aggregate as rigid clumps.
    pub const SPECIMEN: Self = Self::new("specimen", 2).main("quality");
    /// Shapes of stones, as solids and as clumps.
    pub const SHAPES: Self = Self::new("shapes", 1).main("shapes");
    /// A design of experiments.
    pub const DESIGN: Self = Self::new("design", 1).main("design");
    /// One run of a simulator.
    pub const RUN: Self = Self::new("run", 2).main("responses");
    /// Runs or measurements, one per row.
    pub const RESULTS: Self = Self::new("results", 1).main("runs");
    /// A range analysis.
    pub const RANGE: Self = Self::new("range", 1).main("range");
    /// An analysis of variance.
    pub const ANOVA: Self = Self::new("anova", 1).main("anova");
    /// Effects of an unreplicated design.
    pub const SCREENING: Self = Self::new("screening", 1).main("effects");
    /// Fitted models.
    pub const SURFACES: Self = Self::new("surfaces", 1).main("fit");
    /// One fit for each group of rows.
    pub const GROUPS: Self = Self::new("groups", 1).main("groups");
    /// Calibrated parameters.
    pub const SOLUTION: Self = Self::new("solution", 1).main("solution");
    /// Calibrated parameters on fresh specimens.
    pub const VERIFICATION: Self = Self::new("verification", 1).main("summary");
    /// Computed values beside values from elsewhere.
    pub const AGREEMENT: Self = Self::new("agreement", 1).main("summary");
    /// Strength over confining stress.
    pub const ENVELOPE: Self = Self::new("envelope", 1).main("parameters");
    /// A figure with its numbers.
    pub const PICTURE: Self = Self::new("picture", 1).main("data");
    /// A printed table.
    pub const TABLE: Self = Self::new("table", 1).main("table");

    /// A kind without tables; raise the version when the layout changes.
    pub const fn new(name: &'static str, version: u32) -> Self {
        Self { name, version, main_table: None }
    }

    /// Names the table that people look at first: the kind can then be printed.
    #[must_use]
    pub const fn main(self, table: &'static str) -> Self {
        Self { main_table: Some(table), ..self }
    }

    /// The name in files and messages.
    pub const fn name(self) -> &'static str {
        self.name
    }

    /// Version of the layout.
    pub const fn version(self) -> u32 {
        self.version
    }

    /// The table that people look at first; `None` when the kind holds no table.
    pub const fn main_table(self) -> Option<&'static str> {
        self.main_table
    }
}

/// Kinds are equal when their names are: names are unique.
impl PartialEq for ArtifactKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}
impl Eq for ArtifactKind {}

impl fmt::Display for ArtifactKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// Which artifacts an input accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accepts {
    /// Everything that holds a table.
    Tables,
    /// Everything.
    All,
    /// These kinds.
    Only(&'static [ArtifactKind]),
}

impl Accepts {
    /// Whether an artifact of this kind is accepted.
    pub fn takes(self, kind: ArtifactKind) -> bool {
        match self {
            Self::Tables => kind.main_table.is_some(),
            Self::All => true,
            Self::Only(kinds) => kinds.contains(&kind),
        }
    }
}

impl fmt::Display for Accepts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tables => f.write_str("a result with a table"),
            Self::All => f.write_str("any result"),
            Self::Only(kinds) => f.write_str(&kinds.iter().map(|kind| kind.name).collect::<Vec<_>>().join(" or ")),
        }
    }
}
