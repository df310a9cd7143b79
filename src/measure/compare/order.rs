//! Order in which the processes of both sides ran.

use super::matching::{CompareError, Configuration};

/// A doubt about sides that were not measured in turn: drift of the machine then looks like a difference.
pub(super) fn doubt(a: &Configuration, b: &Configuration) -> Option<String> {
    let (Some(of_a), Some(of_b)) = (a.started(), b.started()) else {
        return Some("the records do not say when each process ran: drift may look like a difference".to_owned());
    };
    let of_a = of_a.into_iter().map(|at| (at, "A"));
    let mut order: Vec<(&str, &str)> = of_a.chain(of_b.into_iter().map(|at| (at, "B"))).collect();
    order.sort_unstable();
    // A process against itself.
    if order.first()?.0 == order.last()?.0 {
        return None;
    }
    let (processes, changes) = (order.len(), order.windows(2).filter(|pair| pair[0].1 != pair[1].1).count());
    let how = match changes {
        1 => "one side was measured wholly before the other".to_owned(),
        // Sides in turn change after every process or every second one.
        few if 3 * few < processes => {
            format!("the sides were hardly measured in turn ({few} changes of side in {processes} processes)")
        }
        _ => return None,
    };
    Some(format!("{how}, so that drift looks like a difference: measure them in turn with ab"))
}

/// True when the sides were measured in blocks A B B A: each of the blocks that [`check_blocks`] asks for in that order.
pub(super) fn is_in_blocks(a: &Configuration, b: &Configuration) -> bool {
    let (Some(of_a), Some(of_b)) = (a.started(), b.started()) else { return false };
    let in_order = |(a, b): (&[&str], &[&str])| a[0] < b[0] && b[0] < b[1] && b[1] < a[1];
    of_a.len() >= 4 && check_blocks(a, b).is_ok() && of_a.chunks(2).zip(of_b.chunks(2)).all(in_order)
}

/// Refuses sides that are not of the same blocks, each with two processes of both: block N has the processes 2 N and 2 N + 1.
///
/// Any others would be paired as if drift cancelled in them, and make false certainty.
pub(super) fn check_blocks(a: &Configuration, b: &Configuration) -> Result<(), CompareError> {
    let numbers = a.process_numbers();
    let is_block = |pair: &[u32]| matches!(pair, [first, second] if first % 2 == 0 && *second == first + 1);
    let are_ascending = numbers.windows(2).all(|pair| pair[0] < pair[1]);
    if are_ascending && numbers.chunks(2).all(is_block) && numbers == b.process_numbers() {
        return Ok(());
    }
    Err(CompareError::Blocks { name: a.name() })
}
