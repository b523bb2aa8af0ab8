//! `--max-move` of the general solvers: largest displacement of joints from the start.

use super::arguments::Arguments;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::number_list::Numbers;

/// Largest displacement of every coordinate, in radians and metres, or `None` without the option.
///
/// # Errors
/// A wrong count of numbers; the message lists the coordinates.
pub(super) fn max_moves(loaded: &LoadedModel, arguments: &Arguments) -> Outcome<Option<Vec<f64>>> {
    let Some(Numbers(given)) = &arguments.arm.max_move else {
        return Ok(None);
    };
    let all = loaded.model.configuration_len();
    let each = match given.as_slice() {
        [one] => vec![*one; all],
        each if each.len() == all => each.to_vec(),
        each => {
            return Err(usage!(
                "--max-move: {} numbers given; it takes one, or {all}: {}",
                each.len(),
                loaded.coordinate_names().join(", ")
            ));
        }
    };
    // The displacement of a ball joint is its rotation angle, although its numbers are not angles.
    let turns = loaded.is_angle().zip(loaded.is_of_ball());
    let moves = each.into_iter().zip(turns);
    let moves = moves.map(
        |(most, (angle, ball))| match arguments.degrees && (angle || ball) {
            true => most.to_radians(),
            false => most,
        },
    );
    Ok(Some(moves.collect()))
}
