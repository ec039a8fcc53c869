//! Layered placement of a directed acyclic graph (Sugiyama, Tagawa and Toda 1981, doi:10.1109/TSMC.1981.4308636).
//!
//! Layers follow the longest path; long edges pass through blank nodes; barycentres give the order in each layer, and the
//! order with the fewest crossings is taken; heights minimise the squared distances to the neighbours under a least distance.

/// A layout: layers of nodes, from the first to the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Nodes in their order within each layer.
    pub order: Vec<Vec<usize>>,
    /// Height of each node; neighbours in a layer are at least their distance apart.
    pub height: Vec<f64>,
    /// Each edge as the nodes that it passes.
    pub routes: Vec<Vec<usize>>,
    /// Number of real nodes; nodes from this index on are blank.
    pub nodes: usize,
}

/// Places `nodes` nodes; edges go from source to target. Edges of a cycle are left out of the layering.
pub fn place(nodes: usize, edges: &[(usize, usize)], distance: f64) -> Layers {
    let layer = layers(nodes, edges);
    let depth = layer.iter().max().map_or(0, |m| m + 1);
    let mut order: Vec<Vec<usize>> = vec![Vec::new(); depth];
    for (node, &l) in layer.iter().enumerate() {
        order[l].push(node);
    }
    let mut routes = Vec::new();
    let mut links: Vec<(usize, usize)> = Vec::new();
    let mut places = nodes;
    for &(a, b) in edges {
        let mut route = vec![a];
        for between in order.iter_mut().take(layer[b]).skip(layer[a] + 1) {
            between.push(places);
            route.push(places);
            places += 1;
        }
        route.push(b);
        links.extend(route.windows(2).map(|w| (w[0], w[1])));
        routes.push(route);
    }
    let neighbours = Neighbours::of(places, &links);
    sort(&mut order, &neighbours, &links, places);
    let height = heights(&order, &neighbours, nodes, places, distance);
    Layers { order, height, routes, nodes }
}

struct Neighbours {
    before: Vec<Vec<usize>>,
    after: Vec<Vec<usize>>,
}

impl Neighbours {
    fn of(places: usize, links: &[(usize, usize)]) -> Self {
        let (mut before, mut after) = (vec![Vec::new(); places], vec![Vec::new(); places]);
        for &(a, b) in links {
            after[a].push(b);
            before[b].push(a);
        }
        Self { before, after }
    }
}

/// The layer of each node: the longest path from a source; then sources move up to their first reader.
fn layers(nodes: usize, edges: &[(usize, usize)]) -> Vec<usize> {
    let mut layer = vec![0; nodes];
    for _ in 0..nodes {
        let mut moved = false;
        for &(a, b) in edges {
            if layer[b] < layer[a] + 1 && layer[a] + 1 < nodes {
                layer[b] = layer[a] + 1;
                moved = true;
            }
        }
        if !moved {
            break;
        }
    }
    for node in 0..nodes {
        let is_source = edges.iter().all(|&(_, b)| b != node);
        let first = edges.iter().filter(|&&(a, _)| a == node).map(|&(_, b)| layer[b]).min();
        if let (true, Some(first)) = (is_source, first) {
            layer[node] = first.saturating_sub(1);
        }
    }
    layer
}

fn ranks(order: &[Vec<usize>], places: usize) -> Vec<usize> {
    let mut rank = vec![0; places];
    for layer in order {
        for (k, &p) in layer.iter().enumerate() {
            rank[p] = k;
        }
    }
    rank
}

fn crossings(order: &[Vec<usize>], links: &[(usize, usize)], places: usize) -> usize {
    let rank = ranks(order, places);
    let mut of = vec![0; places];
    for (l, layer) in order.iter().enumerate() {
        layer.iter().for_each(|&p| of[p] = l);
    }
    let mut count = 0;
    for (i, &(a, b)) in links.iter().enumerate() {
        for &(c, d) in &links[..i] {
            let apart = (rank[a] < rank[c]) != (rank[b] < rank[d]);
            count += usize::from(of[a] == of[c] && rank[a] != rank[c] && rank[b] != rank[d] && apart);
        }
    }
    count
}

fn sort(order: &mut Vec<Vec<usize>>, neighbours: &Neighbours, links: &[(usize, usize)], places: usize) {
    let mut best = (crossings(order, links, places), order.clone());
    for sweep in 0..12 {
        let forward = sweep % 2 == 0;
        let depth = order.len();
        for step in 1..depth {
            let l = if forward { step } else { depth - 1 - step };
            let rank = ranks(order, places);
            let centre = |p: usize| {
                let near = if forward { &neighbours.before[p] } else { &neighbours.after[p] };
                let sum: usize = near.iter().map(|&n| rank[n]).sum();
                if near.is_empty() { rank[p] as f64 } else { sum as f64 / near.len() as f64 }
            };
            let mut keyed: Vec<(f64, usize)> = order[l].iter().map(|&p| (centre(p), p)).collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
            order[l] = keyed.into_iter().map(|k| k.1).collect();
        }
        let count = crossings(order, links, places);
        if count < best.0 {
            best = (count, order.clone());
        }
    }
    *order = best.1;
}

/// Moves heights towards the mean of the neighbours by least squares, in sweeps forwards and backwards.
fn heights(order: &[Vec<usize>], neighbours: &Neighbours, nodes: usize, places: usize, distance: f64) -> Vec<f64> {
    let mut y = vec![0.0; places];
    for layer in order {
        for (k, &p) in layer.iter().enumerate() {
            y[p] = (k as f64 - (layer.len() as f64 - 1.0) / 2.0) * distance;
        }
    }
    let gap = |a: usize, b: usize| match (a < nodes, b < nodes) {
        (true, true) => distance,
        (false, false) => 0.35 * distance,
        _ => 0.6 * distance,
    };
    for sweep in 0..24 {
        let depth = order.len();
        for step in 0..depth {
            let l = if sweep % 2 == 0 { step } else { depth - 1 - step };
            let wish = |p: usize| {
                let near: Vec<usize> = neighbours.before[p].iter().chain(&neighbours.after[p]).copied().collect();
                if near.is_empty() { y[p] } else { near.iter().map(|&n| y[n]).sum::<f64>() / near.len() as f64 }
            };
            let wishes: Vec<f64> = order[l].iter().map(|&p| wish(p)).collect();
            let gaps: Vec<f64> = order[l].windows(2).map(|w| gap(w[0], w[1])).collect();
            for (&p, v) in order[l].iter().zip(apart(&wishes, &gaps)) {
                y[p] = v;
            }
        }
    }
    let lowest = y.iter().copied().fold(f64::INFINITY, f64::min);
    y.iter().map(|v| v - lowest).collect()
}

/// The heights nearest to the desired ones (least squares) that preserve order and gaps: pool adjacent violators.
fn apart(wishes: &[f64], gaps: &[f64]) -> Vec<f64> {
    let mut offset = 0.0;
    let mut offsets = vec![0.0];
    for g in gaps {
        offset += g;
        offsets.push(offset);
    }
    let mut blocks: Vec<(f64, usize)> = Vec::new();
    for (w, o) in wishes.iter().zip(&offsets) {
        blocks.push((w - o, 1));
        while blocks.len() > 1 && blocks[blocks.len() - 2].0 > blocks[blocks.len() - 1].0 {
            let (b, n) = blocks.pop().unwrap_or_default();
            if let Some((a, m)) = blocks.last_mut() {
                *a = (*a * *m as f64 + b * n as f64) / (*m + n) as f64;
                *m += n;
            }
        }
    }
    let flat = blocks.into_iter().flat_map(|(v, n)| std::iter::repeat_n(v, n));
    flat.zip(&offsets).map(|(v, o)| v + o).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wishes_are_met_when_there_is_room_and_shared_when_not() {
        assert_eq!(apart(&[0.0, 10.0], &[1.0]), [0.0, 10.0]);
        assert_eq!(apart(&[5.0, 5.0], &[2.0]), [4.0, 6.0]);
        assert_eq!(apart(&[3.0, 0.0, 9.0], &[1.0, 1.0]), [1.0, 2.0, 9.0]);
    }

    #[test]
    fn edges_point_forward_and_twisted_pairs_are_untwisted() {
        // a → d, b → c: the order of the second layer is turned.
        let layout = place(4, &[(0, 3), (1, 2)], 10.0);
        assert_eq!(layout.order, [vec![0, 1], vec![3, 2]]);
        let long = place(3, &[(0, 1), (1, 2), (0, 2)], 10.0);
        assert_eq!(long.routes[2].len(), 3);
        assert!(long.order.iter().map(Vec::len).eq([1, 2, 1]));
        assert_eq!(place(0, &[], 10.0).order.len(), 0);
    }
}
