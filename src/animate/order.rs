//! The order in which a sparse symmetric matrix is eliminated so that little fills in.
//!
//! Approximate minimum degree on the quotient graph (Amestoy, Davis, Duff 1996), without the search for variables that
//! cannot be told apart, which meshes hardly have. Ties go to the lower index, so the order is the same everywhere.

use std::collections::BTreeSet;

/// The order for the graph in which `neighbours[i]` are those of `i` (symmetric, without `i` itself): entry `k` is the
/// `k`-th to be eliminated.
pub(super) fn minimum_degree(neighbours: &[Vec<u32>]) -> Vec<u32> {
    let n = neighbours.len();
    let mut variables: Vec<Vec<u32>> = neighbours.to_vec();
    // The elements (eliminated variables) that a variable belongs to, and the variables of an element.
    let mut elements: Vec<Vec<u32>> = vec![Vec::new(); n];
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); n];
    let mut degree: Vec<usize> = variables.iter().map(Vec::len).collect();
    let mut queue: BTreeSet<(usize, u32)> = degree.iter().enumerate().map(|(i, &d)| (d, i as u32)).collect();
    let (mut gone, mut absorbed) = (vec![false; n], vec![false; n]);
    // Stamps say in which round a mark was set, so that marks need no clearing.
    let (mut seen, mut outside) = (vec![0_u32; n], vec![(0_u32, 0_usize); n]);
    let mut order = Vec::with_capacity(n);
    while let Some((_, pivot)) = queue.pop_first() {
        let round = order.len() as u32 + 1;
        order.push(pivot);
        let p = pivot as usize;
        gone[p] = true;
        // The new element: all that the pivot touches, directly or through its elements, which it takes in.
        seen[p] = round;
        let mut front = Vec::new();
        let own = std::mem::take(&mut variables[p]);
        let old = std::mem::take(&mut elements[p]);
        for &e in &old {
            absorbed[e as usize] = true;
        }
        let through = old.iter().flat_map(|&e| std::mem::take(&mut members[e as usize]));
        for v in own.into_iter().chain(through) {
            if !gone[v as usize] && seen[v as usize] != round {
                seen[v as usize] = round;
                front.push(v);
            }
        }
        // How much of every other element lies outside the new one.
        for &v in &front {
            elements[v as usize].retain(|&e| !absorbed[e as usize]);
            for &e in &elements[v as usize] {
                let entry = &mut outside[e as usize];
                if entry.0 != round {
                    *entry = (round, members[e as usize].len());
                }
                entry.1 -= 1;
            }
        }
        for &v in &front {
            let i = v as usize;
            variables[i].retain(|&u| !gone[u as usize] && seen[u as usize] != round);
            let beyond: usize = elements[i].iter().map(|&e| outside[e as usize].1).sum();
            elements[i].push(pivot);
            let next = (variables[i].len() + beyond + front.len() - 1).min(n - order.len() - 1);
            queue.remove(&(degree[i], v));
            degree[i] = next;
            queue.insert((next, v));
        }
        members[p] = front;
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_fills_nothing_in_and_every_variable_comes_once() {
        let n = 50_u32;
        let path: Vec<Vec<u32>> =
            (0..n).map(|i| [i.wrapping_sub(1), i + 1].into_iter().filter(|&j| j < n).collect()).collect();
        let order = minimum_degree(&path);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..n).collect::<Vec<_>>());
        // On a path every pivot has at most two neighbours left, and elimination joins those.
        let mut alive: Vec<u32> = (0..n).collect();
        for v in order {
            let at = alive.iter().position(|&a| a == v).unwrap();
            assert!(at == 0 || at == alive.len() - 1 || alive.len() > 2);
            alive.remove(at);
        }
        assert!(minimum_degree(&[]).is_empty());
    }
}
