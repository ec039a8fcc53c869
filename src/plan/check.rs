//! From the tree to the workflow: every table read, every name resolved.

use super::collect::{Check, MOST_FAULTS, steps};
use super::fault::{Fault, Source};
use super::file::{FactorTable, Head, ResponseTable};
use super::node::{Node, Sources, Step, Table, Value};
use super::read::read;
use super::{Overrides, StageNode, Workflow, overlay, stages, syntax};
use crate::stage::material::{Material, MaterialTable};
use crate::stage::{Context, OWN_COLUMNS, Outline, symbol_fault};
use crate::unit::Unit;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Keys of the root.
const ROOT: [&str; 6] = ["workflow", "factor", "response", "material", "stage", "profile"];

/// The checked workflow, or every fault of it in the order of the file.
pub(super) fn workflow(
    name: &str,
    text: &str,
    overrides: &Overrides,
    folder: Option<&Path>,
) -> Result<Workflow, Vec<Fault>> {
    let mut sources = Sources(vec![Arc::new(Source { name: name.to_owned(), text: text.to_owned() })]);
    let (tree, mut faults) = syntax::tree(&sources, 0);
    let Some(Node { value: Value::Table(mut root), .. }) = tree else { return Err(faults) };
    let profiles = overlay::names(&root);
    overlay::profile(&mut root, overrides.profile.as_deref(), &mut sources, &mut faults);
    overlay::sets(&mut root, &overrides.sets, &mut sources, &mut faults);
    let mut check = Check { sources: &sources, faults, lost: Vec::new() };
    let mut looked = stages::Looked { folder, absent: Vec::new(), warnings: Vec::new() };
    check.root_keys(&root);
    let head = check.head(&mut root);
    let mut context = Context {
        seed: head.as_ref().map_or(0, |head| head.seed),
        factors: check.named(&mut root, "factor", Check::factor),
        responses: check.named(&mut root, "response", Check::response),
        materials: check.named(&mut root, "material", Check::material),
        ..Context::default()
    };
    let stages = stages::read_all(&mut check, &mut root, &mut context, &mut looked);
    check.settings(&root, &context);
    check.columns(&root, &context);
    let mut faults = check.faults;
    let Some((head, stages)) = head.zip(stages).filter(|_| faults.is_empty()) else {
        faults.sort_by_key(|fault| {
            fault.location.as_ref().map(|location| (location.source.name != name, location.span.start))
        });
        let more = faults.len().saturating_sub(MOST_FAULTS);
        faults.truncate(MOST_FAULTS);
        if more > 0 {
            faults.push(Fault::new(format!("… and {more} more faults")));
        }
        return Err(faults);
    };
    context.outline = outline(&stages);
    Ok(Workflow {
        name: Path::new(name).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        path: PathBuf::from(name),
        title: head.title,
        about: head.about,
        context,
        profile: overrides.profile.clone(),
        profiles,
        stages,
        absent: looked.absent,
        warnings: looked.warnings,
    })
}

/// Names of lines in tables of analyses that are no factors.
const TERMS: [&str; 3] = ["const", "residual", "total"];

fn outline(stages: &[StageNode]) -> Vec<Outline> {
    let one = |stage: &StageNode| {
        let inputs: BTreeSet<usize> = stage.inputs.iter().map(|(_, input)| *input).collect();
        Outline { name: stage.name.clone(), kind: stage.kind.to_owned(), inputs: inputs.into_iter().collect() }
    };
    stages.iter().map(one).collect()
}

impl Check<'_> {
    fn root_keys(&mut self, root: &Table) {
        for (name, entry) in root.in_order().into_iter().take(ROOT.len() + MOST_FAULTS + 1) {
            if !ROOT.contains(&name) {
                let fault = Fault::new(format!("unknown key `{name}`")).at(self.sources.location(entry.key));
                self.faults.push(fault.known(name, "tables", ROOT));
            }
        }
    }

    fn head(&mut self, root: &mut Table) -> Option<Head> {
        match root.0.get_mut("workflow") {
            Some(entry) => {
                read(&mut entry.node, self.sources, &mut self.faults, Vec::new, |reader| Head::deserialize(reader))
            }
            None => {
                let empty = if root.0.is_empty() { "the file is empty: " } else { "" };
                let file = &self.sources.0[0].name;
                let hint = "begin with\n[workflow]\ntitle = \"what it is\"\nseed = 1";
                self.faults.push(Fault::new(format!("{file}: {empty}the table [workflow] is missing")).hint(hint));
                None
            }
        }
    }

    /// The tables below `key`, each read by `one`.
    fn named<T>(
        &mut self,
        root: &mut Table,
        key: &'static str,
        one: impl Fn(&mut Self, &str, &mut Node) -> Option<T>,
    ) -> BTreeMap<String, T> {
        let Some(table) = self.tables(root, key) else { return BTreeMap::new() };
        let mut found = BTreeMap::new();
        for (name, entry) in &mut table.0 {
            if self.faults.len() > MOST_FAULTS {
                break;
            }
            self.name(key, name, entry);
            match one(self, name, &mut entry.node) {
                Some(value) => drop(found.insert(name.clone(), value)),
                None => self.lost.push((key, name.clone())),
            }
        }
        found
    }

    fn factor(&mut self, name: &str, node: &mut Node) -> Option<crate::stage::Factor> {
        let table = read(node, self.sources, &mut self.faults, Vec::new, |reader| FactorTable::deserialize(reader))?;
        let before = self.faults.len();
        self.unit(&table.unit, node);
        self.symbol(table.symbol.as_deref(), node);
        if table.levels.is_empty() && table.range.is_none() {
            let fault = Fault::new(format!("factor `{name}` has neither levels nor a range"));
            let hint = "give it `levels = [10, 20, 30]` or `range = [10, 30]`";
            self.faults.push(fault.at(self.sources.location(node.span)).hint(hint));
        }
        if let Some(range) = table.range
            && range[0] >= range[1]
        {
            let message = format!("the range must rise: {} is not below {}", range[0], range[1]);
            self.complain(node, &steps(["range"]), Fault::new(message));
        }
        self.categories(name, &table, node);
        let mut sorted: Vec<(f64, usize)> = table.numbers().into_iter().zip(0..).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for pair in sorted.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let path = [Step::Key("levels".to_owned()), Step::Index(pair[1].1)];
            self.complain(node, &path, Fault::new(format!("level {} stands here twice", pair[1].0)));
        }
        let factor = table.factor(name);
        self.scale(name, &factor, node);
        (self.faults.len() == before).then_some(factor)
    }

    /// Faults of a factor whose levels are names.
    fn categories(&mut self, name: &str, table: &FactorTable, node: &Node) {
        let (numbers, names) = (table.numbers(), table.names());
        if names.is_empty() {
            return;
        }
        let mut complain = |key: &str, message: String, hint: &str| {
            self.complain(node, &steps([key]), Fault::new(message).hint(hint));
        };
        if !numbers.is_empty() {
            let message = format!("factor `{name}` has numbers and names for levels");
            complain("levels", message, "write all of them as numbers, or all as names in quotes");
        }
        if let Some(twice) = names.iter().enumerate().find(|(i, own)| names[..*i].contains(own)).map(|(_, own)| own) {
            complain("levels", format!("level `{twice}` stands here twice"), "name each level once");
        }
        if let Some(odd) = names.iter().find(|own| own.is_empty() || own.trim() != **own) {
            complain(
                "levels",
                format!("level `{odd}` is empty, or begins or ends with a blank"),
                "leave the blanks out",
            );
        }
        for (key, given) in
            [("range", table.range.is_some()), ("unit", !table.unit.is_empty()), ("sets", !table.sets.0.is_empty())]
        {
            if given {
                let message = format!("`{key}` has no effect on factor `{name}`, whose levels are names");
                complain(key, message, "leave it out");
            }
        }
    }

    fn response(&mut self, name: &str, node: &mut Node) -> Option<crate::stage::Response> {
        let table = read(node, self.sources, &mut self.faults, Vec::new, |reader| ResponseTable::deserialize(reader))?;
        self.unit(&table.unit, node);
        self.symbol(table.symbol.as_deref(), node);
        Some(table.response(name))
    }

    fn material(&mut self, _: &str, node: &mut Node) -> Option<Material> {
        let read_table = |reader: super::reader::Reader<'_>| MaterialTable::deserialize(reader);
        read(node, self.sources, &mut self.faults, Vec::new, read_table).map(|table| table.0)
    }

    /// Factors and responses are columns of one table, beside the program's own.
    fn columns(&mut self, root: &Table, context: &Context) {
        let own = |key| root.0.get(key).map(|entry| &entry.node);
        let names = context.factors.keys().map(|name| ("factor", name));
        for (section, name) in names.chain(context.responses.keys().map(|name| ("response", name))) {
            let Some(node) = own(section) else { continue };
            let Some(column) = OWN_COLUMNS.iter().find(|column| column.eq_ignore_ascii_case(name)) else { continue };
            let message = format!("{section} `{name}` has the name of a column that flow writes, `{column}`");
            let fault = Fault::new(message).hint("give it another name; its `symbol` says how it is shown");
            self.complain(node, &steps([name.as_str()]), fault);
        }
        for name in TERMS.iter().filter(|name| context.factors.contains_key(**name)) {
            let message = format!("factor `{name}` has the name of a line that analyses write beside those of factors");
            let fault = Fault::new(message).hint("give it another name; its `symbol` says how it is shown");
            own("factor").into_iter().for_each(|node| self.complain(node, &steps([*name]), fault.clone()));
        }
        let both = context.responses.keys().filter(|name| context.factors.contains_key(*name));
        for (name, node) in both.filter_map(|name| Some((name, own("response")?))) {
            let message = format!("`{name}` is a factor and a response, which are columns of one table");
            let fault = Fault::new(message).hint("rename one of them; the `symbol` of both may be the same");
            self.complain(node, &steps([name.as_str()]), fault);
        }
    }

    fn symbol(&mut self, symbol: Option<&str>, node: &Node) {
        if let Some(why) = symbol.and_then(symbol_fault) {
            self.complain(node, &steps(["symbol"]), Fault::new(why));
        }
    }

    fn unit(&mut self, unit: &str, node: &Node) {
        if let Err(e) = Unit::parse(unit) {
            self.complain(node, &steps(["unit"]), Fault::new(e.to_string()));
        }
    }
}
