//! The file of `modes --state-space`: matrices, and names and units of their rows and columns.

use std::io::{self, Write};
use std::path::Path;

use serde_json::{Map, Value, json};

use super::arrays::{NamedArray, Values, mat, npz};
use super::json::json as as_text;
use crate::response::{Signal, StateSpace, StateSpaceScope};

/// A form of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateSpaceForm {
    /// JSON, a list for each row of a matrix.
    Json,
    /// Arrays for NumPy.
    Npz,
    /// Arrays for MATLAB and Octave.
    Mat,
}

impl StateSpaceForm {
    /// The form that the ending of the file names.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match &*ending {
            "json" => Some(Self::Json),
            "npz" => Some(Self::Npz),
            "mat" => Some(Self::Mat),
            _ => None,
        }
    }
}

/// A state space, and the link or arm that it is of.
#[derive(Debug, Clone, Copy)]
pub struct StateSpaceFile<'a> {
    /// The matrices.
    pub space: &'a StateSpace,
    /// What they contain.
    pub scope: &'a StateSpaceScope,
    /// Title of the link file.
    pub title: &'a str,
    /// Directions of the links in rad, in a pose.
    pub directions_rad: Option<&'a [f64]>,
    /// The model in words: its modes, and what is left out.
    pub description: &'a str,
}

impl StateSpaceFile<'_> {
    /// Writes the file in a form.
    ///
    /// # Errors
    /// Errors of `out`; more than 2 GiB in an array.
    pub fn write(&self, form: StateSpaceForm, out: &mut (dyn Write + Send)) -> io::Result<()> {
        let space = self.space;
        let second_order = space.second_order();
        let signals = [&space.states, &space.inputs, &space.outputs].map(|own| texts(own));
        let mut arrays = vec![
            ("title", Values::Text(self.title)),
            ("description", Values::Text(self.description)),
        ];
        let [mass, stiffness, damping] = &second_order;
        let of_modes = [("mass", mass), ("stiffness", stiffness), ("damping", damping)];
        let of_states = [("A", &space.a), ("B", &space.b), ("C", &space.c), ("D", &space.d)];
        for (name, matrix) in of_states.into_iter().chain(of_modes) {
            let (rows, columns) = matrix.shape();
            arrays.push((name, Values::Matrix { rows, columns, by_column: matrix.as_slice() }));
        }
        for (keys, own) in
            [["states", "state_units"], ["inputs", "input_units"], ["outputs", "output_units"]]
                .into_iter()
                .zip(&signals)
        {
            arrays.extend(keys.into_iter().zip(own.iter().map(|texts| Values::Texts(texts))));
        }
        arrays.push(("stations_m", Values::Vector(&self.scope.stations_m)));
        arrays.extend(self.directions_rad.map(|own| ("directions_rad", Values::Vector(own))));
        let named: Vec<_> =
            arrays.iter().map(|(name, values)| NamedArray { name, values: *values }).collect();
        match form {
            StateSpaceForm::Json => {
                let object = arrays.iter().map(|(name, own)| ((*name).to_owned(), in_json(own)));
                out.write_all(as_text(&object.collect::<Map<_, _>>()).as_bytes())
            }
            StateSpaceForm::Npz => npz(&named, out),
            StateSpaceForm::Mat => mat(self.title, &named, out),
        }
    }
}

/// Names and units.
fn texts(signals: &[Signal]) -> [Vec<&str>; 2] {
    let names = signals.iter().map(|own| &*own.name);
    [names.collect(), signals.iter().map(|own| &*own.unit).collect()]
}

/// A list for each row of a matrix.
fn in_json(values: &Values<'_>) -> Value {
    match *values {
        Values::Number(number) => json!(number),
        Values::Vector(numbers) => json!(numbers),
        Values::Text(text) => json!(text),
        Values::Texts(texts) => json!(texts),
        Values::Matrix { rows, by_column, .. } => {
            let row = |row: usize| by_column.iter().skip(row).step_by(rows).collect::<Vec<_>>();
            json!((0..rows).map(row).collect::<Vec<_>>())
        }
    }
}
