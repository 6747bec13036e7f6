//! A published transfer that two programs of tests know.

use num_complex::Complex64;

/// Fails unless `transfer(hz)` is T/a of the paper's uniform link in kg m, as another program first
/// computed it for the method. All eight decimals are right.
pub(crate) fn assert_published(transfer: impl Fn(f64) -> Complex64) {
    let published = [
        (0.5, 0.562_901_06, 0.003_859_53),
        (1.0, 0.325_288_92, 0.010_324_43),
        (2.0, -0.084_742_28, 0.009_982_31),
        (5.0, 0.117_039_76, -0.018_344_70),
        (10.0, 0.186_094_01, 0.031_268_97),
        (20.0, -0.263_439_97, -0.065_999_55),
    ];
    for (hz, re, im) in published {
        let off = transfer(hz) - Complex64::new(re, im);
        assert!(off.re.abs() < 5e-9 && off.im.abs() < 5e-9, "{hz} Hz: off by {off}");
    }
}
