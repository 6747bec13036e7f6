use super::error::{Place, TableError, quoted};
use super::heading::check_separator;
use super::rows::read_rows;
use crate::compare::{Cell, Table, TableColumn};

/// Reads any CSV table: a row of names, then rows of numbers or words, `#` before comments.
///
/// If the first row has only numbers, it is data, and the columns are called `column 1`, `column 2` and
/// so on, as is a column without a name. Errors call the file `name`.
///
/// # Errors
/// [`TableError`] names the line of a row with another number of fields than there are columns, of a
/// name that occurs twice, and of text that is not CSV in UTF-8; it refuses an empty table, too.
pub fn read_table(name: &str, bytes: &[u8]) -> Result<Table, TableError> {
    let whole = Place { file: name, line: None };
    let at = |line| Place { line: Some(line), ..whole };
    let table = read_rows(
        name,
        bytes,
        |line, fields| begun(fields, line, at(line)),
        |table, line, fields| push(table, fields, line, at(line)),
    )?;
    table
        .ok_or_else(|| whole.refuse("content", "nothing", "must hold a row of names or of numbers"))
}

/// The table whose first row this is, of names or of numbers.
fn begun(fields: &[&str], line: u64, place: Place) -> Result<Table, TableError> {
    check_separator(fields, place)?;
    if fields.iter().any(|field| field.parse::<f64>().is_err()) {
        return columns(fields, place);
    }
    let mut table = columns(&vec![""; fields.len()], place)?;
    push(&mut table, fields, line, place)?;
    Ok(table)
}

/// A table of these columns without rows.
fn columns(names: &[&str], place: Place) -> Result<Table, TableError> {
    let mut table = Table::default();
    for (index, name) in names.iter().enumerate() {
        let number = format!("column {}", index + 1);
        let own = if name.is_empty() { &number } else { *name };
        if let Some(earlier) = table.names().position(|earlier| earlier == own) {
            let must = format!("must not repeat column {}", earlier + 1);
            return Err(place.refuse(number.as_str(), quoted(own), must));
        }
        table.columns.push(TableColumn::new(own.to_owned()));
    }
    Ok(table)
}

fn push(table: &mut Table, fields: &[&str], line: u64, place: Place) -> Result<(), TableError> {
    let width = table.columns.len();
    if fields.len() != width {
        let must = format!("must be {width}, as many as there are columns");
        return Err(place.refuse("fields", fields.len().to_string(), must));
    }
    for (column, field) in table.columns.iter_mut().zip(fields) {
        column.push(field.parse().map_or(Cell::Word(field), Cell::Number));
    }
    table.lines.push(line);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        read_table("t.csv", text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn names_words_and_numbers_are_read_as_they_stand() {
        let text = "\u{feff}# made by hand\r\n time_s ,\"a, b\",\r\n0,x,1e3\r\n\r\n.5,,-inf\r\n";
        let table = read_table("t.csv", text.as_bytes()).unwrap();
        assert_eq!(table.names().collect::<Vec<_>>(), ["time_s", "a, b", "column 3"]);
        assert_eq!(table.lines, [3, 5]);
        let row = |row| table.columns.iter().map(|column| column.cell(row)).collect::<Vec<_>>();
        assert_eq!(row(0), [Cell::Number(0.0), Cell::Word("x"), Cell::Number(1000.0)]);
        assert_eq!(row(1), [Cell::Number(0.5), Cell::Word(""), Cell::Number(f64::NEG_INFINITY)]);
    }

    #[test]
    fn a_first_row_of_numbers_is_data() {
        let table = read_table("t.csv", b"# time, torque\n1,2\n3,4\n").unwrap();
        assert_eq!(table.names().collect::<Vec<_>>(), ["column 1", "column 2"]);
        assert_eq!(table.lines, [2, 3]);
    }

    #[test]
    fn a_table_of_names_alone_has_no_rows() {
        assert!(read_table("t.csv", b"a,b\n").unwrap().lines.is_empty());
    }

    #[test]
    fn what_is_no_table_is_refused() {
        let nothing = "t.csv: content = nothing, but must hold a row of names or of numbers";
        assert_eq!(refused(""), nothing);
        assert_eq!(refused("# only a remark\n\n"), nothing);
        let ragged = "fields = 1, but must be 2, as many as there are columns";
        assert_eq!(refused("a,b\n1,2\n\n3\n"), format!("t.csv:4: {ragged}"));
        assert_eq!(refused("1,2\n3\n"), format!("t.csv:2: {ragged}"));
        let twice = "t.csv:1: column 3 = \"a\", but must not repeat column 1";
        assert_eq!(refused("a,b, a\n"), twice);
        let utf8 = "t.csv:2: text = byte 0xff, but must be UTF-8";
        assert_eq!(read_table("t.csv", b"a\n\xff\n").unwrap_err().to_string(), utf8);
        let commas = "must name columns that are separated by commas";
        assert_eq!(refused("a;b\n1;2\n"), format!("t.csv:1: first row = \"a;b\", but {commas}"));
    }
}
