//! The `[stage.NAME]` tables: each is read by its kind, then the ports are connected.

mod idle;

use super::collect::{Check, MOST_FAULTS, steps};
use super::fault::{Fault, nearest};
use super::node::{Entry, Node, Step, Table, Value};
use super::read::read;
use super::reader::{Reader, Unread};
use super::{StageNode, graph};
use crate::artifact::{Accepts, ArtifactKind};
use crate::stage::beside::Beside;
use crate::stage::reads;
use crate::stage::simulate::Simulate;
use crate::stage::vary::Template;
use crate::stage::{Class, Complaint, Context, KINDS, Kind, Missing, Port, Stage};
use std::collections::BTreeMap;
use std::path::Path;

/// A stage that was read.
struct Configured {
    name: String,
    title: Option<String>,
    kind: &'static str,
    stage: Box<dyn Stage>,
    ports: Vec<Port>,
}

/// Files beside the workflow that stages name.
pub(super) struct Looked<'a> {
    /// The folder they lie in; none when there is only a text.
    pub(super) folder: Option<&'a Path>,
    /// Those that cannot be read, or lack a column that a stage reads.
    pub(super) absent: Vec<Fault>,
    /// Warnings about them.
    pub(super) warnings: Vec<Fault>,
}

/// The stages in order; all faults go to `check`, and then stages may be missing.
pub(super) fn read_all(
    check: &mut Check<'_>,
    root: &mut Table,
    context: &mut Context,
    looked: &mut Looked<'_>,
) -> Option<Vec<StageNode>> {
    if !root.0.contains_key("stage") {
        let hint = "add a table such as [stage.runs] with its `kind`";
        let file = &check.sources.0[0].name;
        check.faults.push(Fault::new(format!("{file}: the workflow has no stage")).hint(hint));
        return None;
    }
    let materials = root.get("material").cloned();
    let table = check.tables(root, "stage")?;
    let mut stages = configure(check, table, context);
    context.sketches = stages.iter().map(|stage| (stage.name.clone(), stage.stage.sketch())).collect();
    examine(check, table, &stages, materials.as_ref(), context);
    given_materials(&mut stages, context);
    look(check, table, &stages, context, looked);
    idle::tell(check, materials.as_ref(), &stages, context, looked);
    same_but_for_case(check, table);
    let inputs = connect(check, table, &stages);
    let needs: Vec<Vec<usize>> = inputs.iter().map(|inputs| inputs.iter().map(|(_, i)| *i).collect()).collect();
    for cycle in graph::cycles(&needs) {
        tell_cycle(check, table, &stages, &inputs, &cycle);
    }
    Some(in_order(stages, inputs, &graph::order(&needs)))
}

/// Reads every stage by its kind, in the order of the file.
fn configure(check: &mut Check<'_>, table: &mut Table, context: &mut Context) -> Vec<Configured> {
    let set = |name: &str, context: &Context| {
        let paths = context.factors.values().flat_map(|factor| &factor.sets);
        paths.filter_map(|path| path.split_once('.')).any(|(stage, _)| stage == name)
    };
    let mut entries: Vec<(&String, &mut Entry)> = table.0.iter_mut().collect();
    entries.sort_by_key(|(_, entry)| entry.key);
    let mut stages = Vec::new();
    for (name, entry) in entries {
        if check.faults.len() > MOST_FAULTS {
            break;
        }
        check.name("stage", name, entry);
        let Some(kind) = take_kind(check, name, &mut entry.node) else { continue };
        let title = take_title(check, &mut entry.node);
        let keys = || super::schema::keys(kind);
        let by_kind = |reader: Reader<'_>| stage_of(kind, reader);
        let Some(stage) = read(&mut entry.node, check.sources, &mut check.faults, keys, by_kind) else { continue };
        if set(name, context) {
            let template = Template { kind, table: entry.node.json() };
            context.templates.insert(name.clone(), template);
        }
        stages.push(Configured { name: name.clone(), title, kind, ports: stage.inputs(), stage });
    }
    stages
}

/// A stage whose material is no `[material.NAME]` takes it from the stage of that name.
fn given_materials(stages: &mut [Configured], context: &Context) {
    let kinds = Accepts::Only(&[ArtifactKind::RUN, ArtifactKind::SOLUTION]);
    for stage in stages.iter_mut().filter(|stage| stage.kind == Simulate::NAME) {
        let material = stage.stage.sketch().material.filter(|name| !context.materials.contains_key(name));
        if let Some(name) = material.filter(|name| context.sketches.contains_key(name)) {
            stage.ports.push(Port { key: "material", stages: vec![name], accepts: kinds });
        }
    }
}

/// Lets every stage check its settings, now that the sketches of the others are known.
fn examine(check: &mut Check<'_>, table: &Table, stages: &[Configured], materials: Option<&Node>, context: &Context) {
    for Configured { name, stage, .. } in stages {
        let Some(own) = table.get(name) else { continue };
        for complaint in stage.check(context) {
            // It is a consequence of a fault that was reported already.
            if is_lost(check, complaint.missing.as_deref()) {
                continue;
            }
            let path = complaint.material.iter().chain(&complaint.path).map(String::as_str);
            let node = materials.filter(|_| complaint.material.is_some()).unwrap_or(own);
            let path = steps(path);
            check.complain(node, &path, fault_of(complaint));
        }
    }
}

/// Looks at the files that the stages name.
fn look(check: &Check<'_>, table: &Table, stages: &[Configured], context: &Context, looked: &mut Looked<'_>) {
    let Some(folder) = looked.folder else { return };
    let mut columns = BTreeMap::new();
    for stage in stages {
        let Some(node) = table.get(&stage.name) else { continue };
        let mut found = Beside::of(folder);
        stage.stage.beside(context, &mut found);
        looked.absent.extend(found.faults.into_iter().map(|complaint| located(check, node, complaint)));
        looked.warnings.extend(found.warnings.into_iter().map(|complaint| located(check, node, complaint)));
        let design = stage.ports.iter().find(|port| port.key == "design").and_then(|port| port.stages.first());
        let of_runs = || reads::of_simulator(&stage.name, design?, context);
        columns.extend(found.columns.or_else(of_runs).map(|names| (stage.name.clone(), names)));
    }
    look_for_columns(check, table, stages, (&columns, context), looked);
}

/// Looks for the columns that stages read from tables whose columns are known.
fn look_for_columns(
    check: &Check<'_>,
    table: &Table,
    stages: &[Configured],
    (columns, context): (&BTreeMap<String, Vec<String>>, &Context),
    looked: &mut Looked<'_>,
) {
    for stage in stages {
        let Some(node) = table.get(&stage.name) else { continue };
        let analyses = crate::stage::kind(stage.kind).is_some_and(|kind| kind.class == Class::Statistics);
        let named = stage.ports.iter().flat_map(|port| port.stages.iter().map(|name| (port.key, name)));
        for (port, name) in named.filter(|_| analyses && check.lost.is_empty()) {
            let complaint = columns.get(name).and_then(|own| reads::nothing_to_analyse(port, name, own, context));
            looked.absent.extend(complaint.map(|complaint| located(check, node, complaint)));
        }
        for complaint in stage.stage.reads().iter().flat_map(|reads| reads.missing(columns)) {
            let fault = located(check, node, complaint);
            // One that is not declared, or that its stage cannot give, was reported there already.
            let name = |fault: &Fault| fault.missing.as_ref().map(|missing| missing.name.clone());
            let is_said = |other: &Fault| other.location == fault.location && name(other) == name(&fault);
            if !is_lost(check, fault.missing.as_deref()) && !check.faults.iter().chain(&looked.absent).any(is_said) {
                looked.absent.push(fault);
            }
        }
    }
}

/// Whether this name is declared by a table that could not be read.
fn is_lost(check: &Check<'_>, missing: Option<&Missing>) -> bool {
    missing.is_some_and(|missing| check.lost.iter().any(|(section, name)| missing.is(section, name)))
}

/// A complaint as a fault without its location.
fn fault_of(complaint: Complaint) -> Fault {
    let meant = complaint.missing.as_ref().and_then(|missing| {
        nearest(&missing.name, missing.among.iter().map(String::as_str)).map(|near| format!("did you mean `{near}`?"))
    });
    Fault { hint: complaint.hint, missing: complaint.missing, label: meant, ..Fault::new(complaint.message) }
}

/// A complaint about a stage as a fault with its location.
fn located(check: &Check<'_>, node: &Node, complaint: Complaint) -> Fault {
    let location = check.sources.location(node.nearest(&steps(complaint.path.iter().map(String::as_str))).span);
    fault_of(complaint).at(location)
}

fn stage_of(kind: &str, reader: Reader<'_>) -> Result<Box<dyn Stage>, Unread> {
    crate::stage::read(kind, reader).unwrap_or_else(|| panic!("BUG: kind `{kind}` is in the list"))
}

/// Takes `title` out of the table of a stage: no result depends on it.
fn take_title(check: &mut Check<'_>, node: &mut Node) -> Option<String> {
    let Value::Table(table) = &mut node.value else { return None };
    let entry = table.0.remove("title")?;
    let fault = match &entry.node.value {
        Value::Text(text) if !text.trim().is_empty() && text.chars().count() <= LONGEST_TITLE => {
            return Some(text.clone());
        }
        Value::Text(_) => Fault::new(format!("a title has 1 to {LONGEST_TITLE} letters")),
        _ => Fault::new(format!("wanted a title in quotes, found {}", entry.node.describe())),
    };
    check.faults.push(fault.at(check.sources.location(entry.node.span)));
    None
}

/// Longest title of a stage, in letters.
const LONGEST_TITLE: usize = 120;

/// Takes `kind` out of the table of a stage.
fn take_kind(check: &mut Check<'_>, name: &str, node: &mut Node) -> Option<&'static str> {
    let location = check.sources.location(node.span);
    let Value::Table(table) = &mut node.value else {
        let message = format!("stage `{name}` must be a table, found {}", node.describe());
        check.faults.push(Fault::new(message).at(location));
        return None;
    };
    let names = || KINDS.iter().map(|kind| kind.name);
    let Some(entry) = table.0.remove("kind") else {
        let fault = Fault::new(format!("stage `{name}` has no `kind`")).at(location);
        check.faults.push(fault.label("`kind` is needed here").known("", "kinds", names()));
        return None;
    };
    let location = check.sources.location(entry.node.span);
    let Value::Text(word) = &entry.node.value else {
        let message = format!("wanted a kind of stage, found {}", entry.node.describe());
        check.faults.push(Fault::new(message).at(location).known("", "kinds", names()));
        return None;
    };
    let found = names().find(|kind| kind == word);
    if found.is_none() {
        let fault = Fault::new(format!("there is no kind of stage `{}`", super::node::shortened(word))).at(location);
        check.faults.push(fault.known(word, "kinds", names()));
    }
    found
}

/// Results are files named after stages, and some file systems do not know the difference.
fn same_but_for_case(check: &mut Check<'_>, table: &Table) {
    let mut seen: BTreeMap<String, (&str, &Entry)> = BTreeMap::new();
    for (name, entry) in table.in_order() {
        if let Some((other, first)) = seen.insert(name.to_lowercase(), (name, entry)) {
            let fault = Fault::new(format!("stages `{other}` and `{name}` differ only by upper and lower case"));
            let fault =
                fault.at(check.sources.location(entry.key)).also(check.sources.location(first.key), "the other one");
            check.faults.push(fault);
            if check.faults.len() > MOST_FAULTS {
                return;
            }
        }
    }
}

/// The inputs of every stage: port and number of the stage it names.
fn connect(check: &mut Check<'_>, table: &Table, stages: &[Configured]) -> Vec<Vec<(&'static str, usize)>> {
    let numbers: BTreeMap<&str, usize> = stages.iter().map(|stage| stage.name.as_str()).zip(0..).collect();
    let mut inputs = Vec::new();
    for stage in stages {
        if check.faults.len() > MOST_FAULTS {
            return vec![Vec::new(); stages.len()];
        }
        let mut found = Vec::new();
        for (port, at, name) in
            stage.ports.iter().flat_map(|p| p.stages.iter().enumerate().map(move |(i, s)| (p, i, s)))
        {
            match numbers.get(name.as_str()) {
                Some(&number) => {
                    fits(check, table, stage, port, at, &stages[number]);
                    found.push((port.key, number));
                }
                None if table.0.contains_key(name) => {}
                None => {
                    let fault = Fault::new(format!("`{}` names no stage", super::node::shortened(name)));
                    let known = table.in_order().into_iter().map(|(name, _)| name).filter(|known| *known != stage.name);
                    let fault = match name.split_once('[') {
                        // one run of a design
                        Some((whole, _)) if table.0.contains_key(whole) => fault.hint(one_run(whole)),
                        _ => fault.known(name, "stages", known),
                    };
                    put_at_port(check, table, stage, port.key, at, fault);
                }
            }
        }
        inputs.push(found);
    }
    inputs
}

/// The input gives what the port accepts.
fn fits(check: &mut Check<'_>, table: &Table, stage: &Configured, port: &Port, at: usize, input: &Configured) {
    let gives = input.stage.gives();
    if port.accepts.takes(gives) {
        return;
    }
    let message = format!("`{}` wants {}, but stage `{}` gives {gives}", port.key, port.accepts, input.name);
    let fault = Fault::new(message);
    let is_run_of_design = port.accepts.takes(ArtifactKind::RUN) && gives == ArtifactKind::RESULTS;
    let fault = if is_run_of_design { fault.hint(one_run(&input.name)) } else { fault };
    put_at_port(check, table, stage, port.key, at, fault);
}

/// What to do where one run is wanted and a stage has many.
fn one_run(stage: &str) -> String {
    format!(
        "the rows of `{stage}` are not stages of their own: `show = \"curves\"` draws the curves of all, and a single run is a \
         `simulate` stage without a `design`"
    )
}

fn put_at_port(check: &mut Check<'_>, table: &Table, stage: &Configured, key: &str, at: usize, fault: Fault) {
    let mut path = steps(key.split('.'));
    path.push(Step::Index(at));
    if let Some(node) = table.get(&stage.name) {
        check.complain(node, &path, fault);
    }
}

fn tell_cycle(
    check: &mut Check<'_>,
    table: &Table,
    stages: &[Configured],
    inputs: &[Vec<(&'static str, usize)>],
    cycle: &[usize],
) {
    let around = cycle.iter().chain(&cycle[..1]);
    let names: Vec<&str> = around.clone().map(|&i| stages[i].name.as_str()).collect();
    let fault = Fault::new(format!("stages need one another in a circle: {}", names.join(" → ")));
    let mut fault = fault.hint("a stage can only use results of stages that do not need its own");
    for pair in cycle.iter().chain(&cycle[..1]).collect::<Vec<_>>().windows(2) {
        let (needing, needed) = (*pair[0], *pair[1]);
        let Some((key, _)) = inputs[needing].iter().find(|(_, i)| *i == needed) else { continue };
        let Some(node) = table.get(&stages[needing].name) else { continue };
        let location = check.sources.location(node.nearest(&steps(key.split('.'))).span);
        fault = match fault.location {
            None => fault.at(location).label(format!("`{}` needs `{}`", stages[needing].name, stages[needed].name)),
            Some(_) => fault.also(location, format!("`{}` needs `{}`", stages[needing].name, stages[needed].name)),
        };
    }
    check.faults.push(fault);
}

/// The stages in the given order, their inputs renumbered.
fn in_order(stages: Vec<Configured>, inputs: Vec<Vec<(&'static str, usize)>>, order: &[usize]) -> Vec<StageNode> {
    let mut new_number = vec![usize::MAX; stages.len()];
    order.iter().zip(0..).for_each(|(&old, new)| new_number[old] = new);
    let mut nodes: Vec<(usize, StageNode)> = Vec::with_capacity(order.len());
    for ((stage, inputs), &new) in stages.into_iter().zip(inputs).zip(&new_number) {
        if new != usize::MAX {
            let inputs = inputs.into_iter().map(|(port, old)| (port, new_number[old])).collect();
            nodes.push((
                new,
                StageNode { name: stage.name, title: stage.title, kind: stage.kind, stage: stage.stage, inputs },
            ));
        }
    }
    nodes.sort_by_key(|(new, _)| *new);
    nodes.into_iter().map(|(_, node)| node).collect()
}
