use maud::{PreEscaped, html};

use super::figure::Figure;
use crate::numeric::visible_document;

/// What a figure of its own looks like: the light colours of the page.
const STYLE: &str = include_str!("figure.css");

impl Figure {
    /// The figure as a file of its own.
    pub fn svg_file(&self) -> String {
        let drawing = self.svg().into_string();
        let Some(begin) = drawing.find('>') else { return drawing };
        let (head, rest) = drawing.split_at(begin + 1);
        let style = html! {
            title { (self.title) }
            desc { (self.caption) }
            style { (PreEscaped(STYLE)) }
            rect width="100%" height="100%" fill="#ffffff" {}
        };
        visible_document(&format!("{head}{}{rest}\n", style.into_string()))
    }
}
