//! The same bits on any number of threads.

use std::num::NonZeroUsize;

use super::{Smooth, link, solved};

fn bits(histories: &[Vec<f64>]) -> Vec<Vec<u64>> {
    histories.iter().map(|samples| samples.iter().map(|x| x.to_bits()).collect()).collect()
}

#[test]
fn torque_and_nodes_have_the_same_bits_on_one_two_and_seven_threads() {
    let link = link(|parts| parts.hub.viscous_friction_n_m_s_rad = 0.1);
    let answer = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let solution = solved(&link, 12, &Smooth::MOVE.motion());
            let torque = vec![solution.hub().torque_n_m.clone(), solution.hub().angle_rad.clone()];
            let deflections =
                solution.deflections(&[12, 5], NonZeroUsize::MIN).unwrap().histories().samples;
            let moments = solution.moments(&[0, 7], NonZeroUsize::MIN).unwrap().histories().samples;
            [torque, deflections, moments].map(|histories| bits(&histories))
        })
    };
    let alone = answer(1);
    for threads in [2, 7] {
        assert!(answer(threads) == alone, "{threads} threads");
    }
}
