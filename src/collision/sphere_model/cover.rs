//! Greedy set cover of cells by balls (Chvátal 1979).

use std::collections::BinaryHeap;

use super::candidates::grown;
use super::cells::Cell;
use super::solid::Solid;
use crate::collision::Ball;
use crate::interruption::is_stopped;

/// The chosen balls, with the cells assigned to each.
#[derive(Debug, Default)]
pub(super) struct Cover {
    pub(super) balls: Vec<Ball>,
    pub(super) cells: Vec<Vec<Cell>>,
}

/// Covers cells by candidate balls. A cell that no candidate contains gets an additional ball. That ball contains the
/// cell, as cells are finer than the allowed protrusion.
pub(super) fn cover(
    solid: &Solid<'_>,
    surface: Vec<Cell>,
    inner: Vec<Cell>,
    candidates: &[Ball],
    max_protrusion: f64,
) -> Cover {
    let mut chosen = greedy(&surface, candidates);
    for cell in &surface {
        if is_stopped() {
            return Cover::default();
        }
        if !holds(&chosen, cell) {
            chosen.push(grown(solid, cell.heart, max_protrusion));
        }
    }
    let mut cells = surface;
    let mut rest = inner;
    while let Some(cell) = rest.pop() {
        if is_stopped() {
            return Cover::default();
        }
        // A large cell may be covered by several balls that each contain a part.
        if holds(&chosen, &cell) {
            cells.push(cell);
        } else if cell.half > max_protrusion / 4.0 {
            rest.extend(cell.split(solid));
        } else {
            chosen.push(grown(solid, cell.centre, max_protrusion));
            cells.push(cell);
        }
    }
    assign(chosen, cells)
}

pub(super) fn holds(balls: &[Ball], cell: &Cell) -> bool {
    balls.iter().any(|ball| cell.is_in(ball))
}

fn greedy(cells: &[Cell], candidates: &[Ball]) -> Vec<Ball> {
    let held = |ball: &Ball| -> Vec<u32> {
        if is_stopped() {
            return Vec::new();
        }
        let holds = |(index, cell): (usize, &Cell)| cell.is_in(ball).then_some(index as u32);
        cells.iter().enumerate().filter_map(holds).collect()
    };
    let held: Vec<Vec<u32>> = candidates.iter().map(held).collect();
    let mut covered = vec![false; cells.len()];
    // The gain of a ball never increases, so an old value is an upper bound. Ties go to the first candidate.
    let first = held.iter().enumerate();
    let mut heap: BinaryHeap<(usize, std::cmp::Reverse<usize>)> = first
        .map(|(k, held)| (held.len(), std::cmp::Reverse(k)))
        .collect();
    let mut chosen = Vec::new();
    while let Some((bound, std::cmp::Reverse(k))) = heap.pop() {
        let left = held[k]
            .iter()
            .filter(|cell| !covered[**cell as usize])
            .count();
        if left == 0 {
            continue;
        }
        if left < bound && heap.peek().is_some_and(|(next, _)| *next > left) {
            heap.push((left, std::cmp::Reverse(k)));
            continue;
        }
        held[k]
            .iter()
            .for_each(|cell| covered[*cell as usize] = true);
        chosen.push(k);
    }
    // Drops balls that later ones made redundant.
    let mut times = vec![0_u32; cells.len()];
    for &k in &chosen {
        held[k].iter().for_each(|cell| times[*cell as usize] += 1);
    }
    chosen.retain(|&k| {
        let needed = held[k].iter().any(|cell| times[*cell as usize] == 1);
        if !needed {
            held[k].iter().for_each(|cell| times[*cell as usize] -= 1);
        }
        needed
    });
    chosen.into_iter().map(|k| candidates[k]).collect()
}

/// Assigns each cell to the ball that contains it with the least increase of the ball's required radius.
fn assign(balls: Vec<Ball>, mut cells: Vec<Cell>) -> Cover {
    let holders = |cell: &Cell| {
        if is_stopped() {
            return 0;
        }
        let holding = |ball: &&Ball| cell.is_in(ball);
        balls.iter().filter(holding).count()
    };
    // Cells with the fewest choices first.
    cells.sort_by_cached_key(holders);
    let mut needed = vec![0.0_f64; balls.len()];
    let mut own: Vec<Vec<Cell>> = vec![Vec::new(); balls.len()];
    for cell in cells {
        if is_stopped() {
            return Cover::default();
        }
        let mut best: Option<(f64, usize, f64)> = None;
        for (k, ball) in balls.iter().enumerate() {
            if !cell.is_in(ball) {
                continue;
            }
            let needs = cell.needs(ball.centre);
            let more = (needs - needed[k]).max(0.0);
            if best.is_none_or(|(least, ..)| more < least) {
                best = Some((more, k, needs));
            }
        }
        if let Some((_, k, needs)) = best {
            needed[k] = needed[k].max(needs);
            own[k].push(cell);
        }
    }
    let kept = balls
        .into_iter()
        .zip(own)
        .filter(|(_, own)| !own.is_empty());
    let (balls, cells) = kept.unzip();
    Cover { balls, cells }
}
