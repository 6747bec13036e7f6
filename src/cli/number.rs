use flexlink::numeric::significant;

/// Several numbers with `digits` significant digits each.
pub(crate) fn list(values: &[f64], digits: usize) -> String {
    if values.is_empty() {
        return "none".into();
    }
    values.iter().map(|value| significant(*value, digits)).collect::<Vec<_>>().join(" ")
}
