//! The tree of values that every artifact is, and the bytes its hash is taken over.

/// One value or a group of values.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// Named nodes.
    Group(Group),
    /// Columns of equal length.
    Table(Table),
    /// Numbers of one type with a shape.
    Array(Array),
    /// Text.
    Text(String),
    /// One real number with its unit (`""` for a pure number).
    Real {
        /// The number, in `unit`.
        value: f64,
        /// Unit, such as `Pa`.
        unit: String,
    },
    /// One whole number.
    Int(i64),
    /// Yes or no.
    Flag(bool),
    /// Raw bytes, such as a picture.
    Bytes(Vec<u8>),
}

/// Named nodes, in the order of their names. There are few in a group, and a hundred thousand artifacts may be in memory: a
/// sorted list takes a tenth of the room of a tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group(Vec<(String, Node)>);

impl Group {
    /// An empty group.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a node; a second one of the same name is a programming error.
    #[must_use]
    pub fn with(mut self, name: &str, node: Node) -> Self {
        self.put(name, node);
        self
    }

    /// Adds a node; a second one of the same name is a programming error.
    pub fn put(&mut self, name: &str, node: Node) {
        assert!(!name.is_empty() && !name.contains('/'), "BUG: `{name}` cannot name a node");
        match self.index(name) {
            Ok(_) => panic!("BUG: two nodes named `{name}`"),
            Err(index) => {
                self.0.reserve_exact(1);
                self.0.insert(index, (name.to_owned(), node));
            }
        }
    }

    /// The node called `name`.
    pub fn get(&self, name: &str) -> Option<&Node> {
        self.index(name).ok().map(|index| &self.0[index].1)
    }

    /// Where a node of this name is, or where it would have to be.
    fn index(&self, name: &str) -> Result<usize, usize> {
        self.0.binary_search_by(|(other, _)| other.as_str().cmp(name))
    }

    /// All nodes in the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Node)> {
        self.0.iter().map(|(name, node)| (name.as_str(), node))
    }

    pub(super) fn canonicalise(&mut self) {
        self.0.iter_mut().for_each(|(_, node)| node.canonicalise());
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.iter().map(|(name, node)| name.len() + 64 + node.bytes()).sum()
    }

    pub(super) fn feed(&self, hash: &mut blake3::Hasher) {
        feed_length(hash, self.0.len());
        for (name, node) in &self.0 {
            feed_text(hash, name);
            node.feed(hash);
        }
    }
}

/// Columns of equal length: what a person reads as a table, and what designs, runs and statistics exchange.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// One line on what the table holds; not hashed.
    pub about: String,
    /// The columns in reading order.
    pub columns: Vec<Column>,
}

impl Table {
    /// The column called `name`.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Adds a column of real numbers; NaN stands for a missing value.
    #[must_use]
    pub fn reals_column(self, name: &str, unit: &str, about: &str, values: Vec<f64>) -> Self {
        self.push(name, unit, about, Values::Reals(values))
    }

    /// Adds a column of whole numbers.
    #[must_use]
    pub fn ints_column(self, name: &str, about: &str, values: Vec<i64>) -> Self {
        self.push(name, "", about, Values::Ints(values))
    }

    /// Adds a column of texts.
    #[must_use]
    pub fn texts_column(self, name: &str, about: &str, values: Vec<String>) -> Self {
        self.push(name, "", about, Values::Texts(values))
    }

    fn push(mut self, name: &str, unit: &str, about: &str, values: Values) -> Self {
        assert!(self.column(name).is_none(), "BUG: two columns named `{name}`");
        assert!(self.columns.is_empty() || self.rows() == values.len(), "BUG: column `{name}` has another length");
        self.columns.push(Column { name: name.to_owned(), unit: unit.to_owned(), about: about.to_owned(), values });
        self
    }
}

/// One column of a [`Table`].
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name, unique in the table.
    pub name: String,
    /// Unit of the values, `""` for pure numbers and texts.
    pub unit: String,
    /// One line on what it holds; not hashed.
    pub about: String,
    /// The values.
    pub values: Values,
}

/// The values of a column or array, all of one type.
#[derive(Clone, Debug)]
pub enum Values {
    /// Real numbers; NaN stands for a missing value.
    Reals(Vec<f64>),
    /// Whole numbers.
    Ints(Vec<i64>),
    /// Texts.
    Texts(Vec<String>),
}

/// Equality is that of the hash: every missing value equals every other, and −0 equals 0.
impl PartialEq for Values {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Reals(a), Self::Reals(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| canonical(*a) == canonical(*b))
            }
            (Self::Ints(a), Self::Ints(b)) => a == b,
            (Self::Texts(a), Self::Texts(b)) => a == b,
            (Self::Reals(_) | Self::Ints(_) | Self::Texts(_), _) => false,
        }
    }
}

impl Values {
    /// Whether people can read all of them as they are: levels and counts need no rounding.
    pub fn are_short(&self) -> bool {
        match self {
            Self::Reals(values) => values.iter().all(|x| !x.is_finite() || format!("{x}").len() <= 6),
            Self::Ints(_) | Self::Texts(_) => true,
        }
    }

    /// Whether they are numbers.
    pub fn are_numbers(&self) -> bool {
        matches!(self, Self::Reals(_) | Self::Ints(_))
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Reals(values) => values.len(),
            Self::Ints(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The type in a person's words.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Reals(_) => "reals",
            Self::Ints(_) => "whole numbers",
            Self::Texts(_) => "texts",
        }
    }

    fn canonicalise(&mut self) {
        if let Self::Reals(values) = self {
            values.iter_mut().for_each(|value| *value = f64::from_bits(canonical(*value)));
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Reals(values) => 8 * values.len(),
            Self::Ints(values) => 8 * values.len(),
            Self::Texts(values) => values.iter().map(|value| 24 + value.len()).sum(),
        }
    }

    fn feed(&self, hash: &mut blake3::Hasher) {
        feed_length(hash, self.len());
        match self {
            Self::Reals(values) => {
                hash.update(b"r");
                feed_words(hash, values.iter().map(|value| canonical(*value)));
            }
            Self::Ints(values) => {
                hash.update(b"i");
                feed_words(hash, values.iter().map(|value| *value as u64));
            }
            Self::Texts(values) => {
                hash.update(b"t");
                let mut bytes = Vec::with_capacity(BLOCK.min(self.bytes()));
                for value in values {
                    bytes.extend_from_slice(&(value.len() as u64).to_le_bytes());
                    bytes.extend_from_slice(value.as_bytes());
                    if bytes.len() >= BLOCK {
                        hash.update(&bytes);
                        bytes.clear();
                    }
                }
                hash.update(&bytes);
            }
        }
    }
}

/// Numbers of one type with a shape (row major) and a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Lengths of the axes; their product is the number of values.
    pub shape: Vec<usize>,
    /// Unit of the values.
    pub unit: String,
    /// One line on what it holds; not hashed.
    pub about: String,
    /// The values, row major.
    pub values: Values,
}

impl Node {
    /// The texts of an array of texts.
    pub fn texts(&self) -> Option<&[String]> {
        match self {
            Self::Array(Array { values: Values::Texts(texts), .. }) => Some(texts),
            _ => None,
        }
    }

    fn canonicalise(&mut self) {
        match self {
            Self::Group(group) => group.canonicalise(),
            Self::Table(table) => table.columns.iter_mut().for_each(|column| column.values.canonicalise()),
            Self::Array(array) => array.values.canonicalise(),
            Self::Real { value, .. } => *value = f64::from_bits(canonical(*value)),
            Self::Text(_) | Self::Int(_) | Self::Flag(_) | Self::Bytes(_) => {}
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Group(group) => group.bytes(),
            Self::Table(table) => table.columns.iter().map(|column| 96 + column.values.bytes()).sum(),
            Self::Array(array) => 96 + array.values.bytes(),
            Self::Text(text) => text.len(),
            Self::Bytes(bytes) => bytes.len(),
            Self::Real { .. } | Self::Int(_) | Self::Flag(_) => 8,
        }
    }

    pub(super) fn feed(&self, hash: &mut blake3::Hasher) {
        hash.update(self.tag());
        match self {
            Self::Group(group) => group.feed(hash),
            Self::Table(table) => {
                feed_length(hash, table.columns.len());
                for column in &table.columns {
                    feed_text(hash, &column.name);
                    feed_text(hash, &column.unit);
                    column.values.feed(hash);
                }
            }
            Self::Array(array) => {
                feed_length(hash, array.shape.len());
                array.shape.iter().for_each(|&n| feed_length(hash, n));
                feed_text(hash, &array.unit);
                array.values.feed(hash);
            }
            Self::Text(text) => feed_text(hash, text),
            Self::Real { value, unit } => {
                hash.update(&canonical(*value).to_le_bytes());
                feed_text(hash, unit);
            }
            Self::Int(value) => {
                hash.update(&value.to_le_bytes());
            }
            Self::Flag(value) => {
                hash.update(&[u8::from(*value)]);
            }
            Self::Bytes(bytes) => {
                feed_length(hash, bytes.len());
                hash.update(bytes);
            }
        }
    }

    fn tag(&self) -> &'static [u8] {
        match self {
            Self::Group(_) => b"G",
            Self::Table(_) => b"T",
            Self::Array(_) => b"A",
            Self::Text(_) => b"S",
            Self::Real { .. } => b"R",
            Self::Int(_) => b"I",
            Self::Flag(_) => b"F",
            Self::Bytes(_) => b"B",
        }
    }

    /// The type in a person's words, for messages such as "wanted reals, found text".
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Group(_) => "group",
            Self::Table(_) => "table",
            Self::Array(array) => array.values.type_name(),
            Self::Text(_) => "text",
            Self::Real { .. } => "real",
            Self::Int(_) => "whole number",
            Self::Flag(_) => "flag",
            Self::Bytes(_) => "bytes",
        }
    }
}

/// The bits a number is hashed by: one NaN, one zero.
fn canonical(value: f64) -> u64 {
    if value.is_nan() {
        f64::NAN.to_bits() & !(1 << 63)
    } else if value == 0.0 {
        0
    } else {
        value.to_bits()
    }
}

pub(super) fn feed_text(hash: &mut blake3::Hasher, text: &str) {
    feed_length(hash, text.len());
    hash.update(text.as_bytes());
}

/// Bytes that are hashed at once: enough for all the lanes of the widest vectors.
const BLOCK: usize = 1 << 16;

fn feed_words(hash: &mut blake3::Hasher, words: impl ExactSizeIterator<Item = u64>) {
    let mut bytes = Vec::with_capacity(BLOCK.min(8 * words.len()));
    for word in words {
        bytes.extend_from_slice(&word.to_le_bytes());
        if bytes.len() == BLOCK {
            hash.update(&bytes);
            bytes.clear();
        }
    }
    hash.update(&bytes);
}

fn feed_length(hash: &mut blake3::Hasher, n: usize) {
    hash.update(&(n as u64).to_le_bytes());
}
