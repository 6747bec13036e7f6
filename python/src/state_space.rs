//! A state space, which opens in python-control and SciPy.

use flexlink::cli::modes::state_space_of;
use flexlink::response::{Signal, StateSpaceScope};
use flexlink::spec::Specification;

use crate::arrays::{OneOrEach, rows};
use crate::prelude::*;
use crate::threads::until_pressed;

/// Small motions of a link or an arm in state space: the matrices ``A``, ``B``, ``C``, ``D``, and names and units of their
/// ``states``, ``inputs`` and ``outputs``.
///
/// It is the sequence of its four matrices, as ``control.ss(*space)`` and ``scipy.signal.StateSpace(*space)`` take them;
/// ``control.ss(*space, **space.names)`` has the names, too.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct StateSpace {
    space: flexlink::response::StateSpace,
    description: String,
}

/// A matrix as an array.
macro_rules! array {
    ($py:expr, $matrix:expr) => {{
        let (count, matrix) = ($matrix.nrows(), &$matrix);
        let columns: Vec<&[f64]> = matrix.as_slice().chunks_exact(count).collect();
        rows($py, &columns, count)
    }};
}

impl StateSpace {
    /// Modes of a link or an arm.
    pub(crate) fn of(
        py: Python<'_>,
        specification: &Specification,
        at: Option<OneOrEach<f64>>,
        scope: &StateSpaceScope,
    ) -> Raises<Self> {
        let count = scope.modes.count();
        if !(1..=1000).contains(&count) {
            let message = format!("modes = {count}, but must be 1 to 1000");
            return Err(usage(&message, None).into());
        }
        let at = at.map(OneOrEach::list);
        let compute = || state_space_of(specification, at.as_deref(), scope);
        let (modes, space, description) = until_pressed(py, compute)?;
        warn(py, &modes.warnings(&specification.arm))?;
        Ok(Self { space, description })
    }
}

fn names(signals: &[Signal]) -> Vec<&str> {
    signals.iter().map(|own| &*own.name).collect()
}

fn units(signals: &[Signal]) -> Vec<&str> {
    signals.iter().map(|own| &*own.unit).collect()
}

#[pymethods]
#[expect(non_snake_case, reason = "names of the matrices")]
impl StateSpace {
    /// A, with a row for each state.
    #[getter]
    fn A<'py>(&self, py: Python<'py>) -> Table<'py> {
        Ok(array!(py, self.space.a)?)
    }

    /// B, with a row for each state and a column for each input.
    #[getter]
    fn B<'py>(&self, py: Python<'py>) -> Table<'py> {
        Ok(array!(py, self.space.b)?)
    }

    /// C, with a row for each output.
    #[getter]
    fn C<'py>(&self, py: Python<'py>) -> Table<'py> {
        Ok(array!(py, self.space.c)?)
    }

    /// D, with a row for each output and a column for each input.
    #[getter]
    fn D<'py>(&self, py: Python<'py>) -> Table<'py> {
        Ok(array!(py, self.space.d)?)
    }

    /// M of the modal equations ``mass @ q'' + damping @ q' + stiffness @ q = B[n:] @ u``: the unit matrix, for coordinates q in
    /// kg^0.5 m.
    #[getter]
    fn mass<'py>(&self, py: Python<'py>) -> Table<'py> {
        Ok(array!(py, self.space.second_order()[0])?)
    }

    /// K of the modal equations, in 1/s².
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> Table<'py> {
        Ok(array!(py, self.space.second_order()[1])?)
    }

    /// C of the modal equations, in 1/s.
    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> Table<'py> {
        Ok(array!(py, self.space.second_order()[2])?)
    }

    /// Names of the states: coordinates of the modes, then their rates.
    #[getter]
    fn states(&self) -> Vec<&str> {
        names(&self.space.states)
    }

    /// Names of the inputs.
    #[getter]
    fn inputs(&self) -> Vec<&str> {
        names(&self.space.inputs)
    }

    /// Names of the outputs.
    #[getter]
    fn outputs(&self) -> Vec<&str> {
        names(&self.space.outputs)
    }

    /// ``states``, ``inputs`` and ``outputs`` as keywords of ``control.ss``.
    #[getter]
    fn names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let lists =
            [("states", self.states()), ("inputs", self.inputs()), ("outputs", self.outputs())];
        lists.into_py_dict(py)
    }

    /// Units of all states, inputs and outputs by name.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = [&self.space.states, &self.space.inputs, &self.space.outputs];
        all.into_iter().flat_map(|own| names(own).into_iter().zip(units(own))).into_py_dict(py)
    }

    /// The modes and the damping in words.
    #[getter]
    fn description(&self) -> &str {
        &self.description
    }

    fn __len__(&self) -> usize {
        let space = &self.space;
        [&space.a, &space.b, &space.c, &space.d].len()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: Any<'py>) -> PyResult<Any<'py>> {
        self.matrices(py)?.as_any().get_item(index)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        Ok(self.matrices(py)?.as_any().try_iter()?.into_any())
    }

    fn __repr__(&self) -> String {
        let [states, inputs, outputs] =
            [&self.space.states, &self.space.inputs, &self.space.outputs].map(Vec::len);
        format!("StateSpace(states={states}, inputs={inputs}, outputs={outputs})")
    }
}

impl StateSpace {
    fn matrices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let space = &self.space;
        let all = [
            array!(py, space.a)?,
            array!(py, space.b)?,
            array!(py, space.c)?,
            array!(py, space.d)?,
        ];
        PyTuple::new(py, all)
    }
}
