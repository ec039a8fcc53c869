//! What the board keeps of tasks, and how it finds them.

use super::*;
use serde_json::json;

fn task(name: &str) -> Task {
    Task::new("formula", json!({ "name": name }))
}

fn result(number: u8) -> ContentHash {
    ContentHash([number; 32])
}

fn board(tasks: Vec<Task>) -> (Board, Vec<NodeId>) {
    let (mut board, mut new) = (Board::default(), Vec::new());
    let nodes = tasks.into_iter().map(|task| board.put(Arc::new(task), 0, &mut new)).collect();
    assert_eq!(new, (0..board.len()).collect::<Vec<_>>());
    (board, nodes)
}

#[test]
fn what_was_computed_for_others_is_let_go_and_what_gathers_or_was_cached_is_not() {
    let row = Arc::new(task("row"));
    let seen = Arc::downgrade(&row);
    let gather = Task::new(GATHER.name, json!({})).after("run", row).after("run", Arc::new(task("other")));
    let (mut board, nodes) = board(vec![gather]);
    assert_eq!((nodes, seen.strong_count()), (vec![2], 1));
    assert!(board.done(0, result(7), false).is_empty());
    assert_eq!(seen.strong_count(), 0, "its result is all that is needed");
    assert_eq!(board.done(1, result(8), true), [2]);
    assert_eq!(*board.task(1).as_ref(), task("other"), "an audit computes it again");
    assert_eq!(board.inputs(2), Some(vec![result(7), result(8)]));
    assert!(board.key(2).is_some() && board.done(2, result(9), false).is_empty());
    assert_eq!(board.task(2).work, GATHER.name);
    let found = board.find(&task("row")).map(|node| board.state(node));
    assert_eq!(found, Some(TaskState::Done { content: result(7), cached: false }));
}

#[test]
fn a_task_that_several_refer_to_is_one_node() {
    let shared = Arc::new(task("specimen"));
    let of = |name: &str| task(name).after("specimen", Arc::clone(&shared));
    let gather = ["a", "b", "c"].map(|name| Arc::new(of(name)));
    let gather = gather.into_iter().fold(Task::new(GATHER.name, json!({})), |task, run| task.after("run", run));
    let (mut board, _) = board(vec![gather]);
    board.forget_addresses();
    assert_eq!(board.len(), 5);
    assert_eq!(board.done(0, result(1), false), [1, 2, 3], "in the order they came");
    assert_eq!(board.put(shared, 0, &mut Vec::new()), 0);
}

#[test]
fn tasks_that_come_to_one_key_are_found_together() {
    let of = |specimen: &str| task("test").after("specimen", Arc::new(task(specimen)));
    let (mut board, nodes) = board(vec![of("one"), of("two"), task("alone")]);
    assert_eq!(nodes, [1, 3, 4]);
    assert_eq!((board.done(0, result(1), false), board.done(2, result(1), true)), (vec![1], vec![3]));
    let keys = nodes.iter().map(|&node| board.key(node).unwrap()).collect::<Vec<_>>();
    assert_eq!(keys[0], keys[1]);
    assert_eq!(board.of_key(&keys[0]).collect::<Vec<_>>(), [1, 3]);
    assert_eq!(board.of_key(&keys[2]).collect::<Vec<_>>(), [4]);
    [1, 3].into_iter().for_each(|node| board.hand_over(node));
    assert_eq!([0; 3].map(|_| board.take_back(&keys[0])), [Some(1), Some(3), None]);
    assert_eq!((board.away(&keys[2]), board.ended(&keys[0])), (None, None));
    board.failed(1, "no peak");
    assert_eq!((board.ended(&keys[0]), board.ended(&keys[2])), (Some(Some("no peak")), None));
    board.done(4, result(2), false);
    let ended = board.all_ended().collect::<HashMap<_, _>>();
    assert_eq!((ended[&keys[0]].as_deref(), ended[&keys[2]].as_deref()), (Some("no peak"), None));
    assert_eq!(ended.len(), 3, "the specimen that was in the store did not run");
}

#[test]
fn what_needs_a_failed_task_is_skipped_with_its_cause() {
    let middle = task("middle").after("in", Arc::new(task("first")));
    let (mut board, nodes) = board(vec![task("last").after("in", Arc::new(middle)), task("other")]);
    board.failed(0, "why");
    assert_eq!((board.state(nodes[0]), board.state(nodes[1])), (TaskState::Skipped, TaskState::Open));
    assert_eq!((board.cause(nodes[0]), board.count(0).skipped), (Some((0, "why")), 2));
    let late = board.put(Arc::new(task("late").after("in", Arc::new(task("first")))), 0, &mut Vec::new());
    assert_eq!(board.state(late), TaskState::Skipped);
}
