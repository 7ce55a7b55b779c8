//! Pages of HTML that need no other file.

use std::fmt::Write;

use crate::picture::Picture;
use crate::text::escaped;

const STYLE: &str = include_str!("page.css");
/// Of axes and text in charts; on a page they take the colour of its text.
const INK: &str = "\"#808080\"";

/// A page that grows from top to bottom. Nothing that is put into it can be markup, but charts.
#[derive(Debug, Clone)]
pub struct Page {
    text: String,
}

impl Page {
    /// A page with its title. `maker` is the program that makes it.
    pub fn new(title: &str, maker: &str) -> Self {
        let (title, maker) = (escaped(title), escaped(maker));
        Self {
            text: format!(
                "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
                 <meta name=\"generator\" content=\"{maker}\"/>\n\
                 <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
                 <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
            ),
        }
    }

    /// Whether a text begins as pages of a maker do.
    pub fn is_by(text: &str, maker: &str) -> bool {
        let sign = format!("<meta name=\"generator\" content=\"{}\"/>", escaped(maker));
        text.starts_with("<!DOCTYPE html>") && text.lines().take(6).any(|line| line == sign)
    }

    fn element(&mut self, opening: &str, text: &str, closing: &str) {
        self.text.push_str(opening);
        self.text.push_str(text);
        self.text.push_str(closing);
        self.text.push('\n');
    }

    /// Begins a section.
    pub fn heading(&mut self, text: &str) {
        self.element("<h2>", &escaped(text), "</h2>");
    }

    /// A paragraph.
    pub fn text(&mut self, text: &str) {
        self.element("<p>", &escaped(text), "</p>");
    }

    /// A paragraph of less weight.
    pub fn remark(&mut self, text: &str) {
        self.element("<p class=\"soft\">", &escaped(text), "</p>");
    }

    /// A paragraph that warns.
    pub fn warning(&mut self, text: &str) {
        self.element("<p class=\"failed\">", &escaped(text), "</p>");
    }

    /// A list.
    pub fn list<'a>(&mut self, items: impl IntoIterator<Item = &'a str>) {
        let items = items.into_iter();
        let items: String = items
            .map(|item| format!("<li>{}</li>\n", escaped(item)))
            .collect();
        if !items.is_empty() {
            self.element("<ul>\n", &items, "</ul>");
        }
    }

    /// Terms and what they are.
    pub fn terms(&mut self, terms: &[(&str, String)]) {
        let terms = terms.iter();
        let terms = terms
            .map(|(term, what)| format!("<dt>{}</dt><dd>{}</dd>\n", escaped(term), escaped(what)));
        self.element("<dl>\n", &terms.collect::<String>(), "</dl>");
    }

    /// A table, which scrolls by itself where it is wider than the page.
    pub fn table(&mut self, table: &Table) {
        self.element(
            "<div class=\"wide\"><table>\n",
            &table.html(),
            "</table></div>",
        );
    }

    /// Charts side by side as far as there is room, each an SVG document with its title.
    pub fn charts<'a>(&mut self, charts: impl IntoIterator<Item = (&'a str, String)>) {
        let charts: String = charts
            .into_iter()
            .map(|(title, svg)| format!("<figure>\n{}\n</figure>\n", inline(&svg, title)))
            .collect();
        if !charts.is_empty() {
            self.element("<div class=\"grid\">\n", &charts, "</div>");
        }
    }

    /// A chart, for wide and for narrow pages, with what there is to say of it.
    pub fn chart(&mut self, title: &str, [wide, narrow]: [&str; 2], remark: &str) {
        let [wide, narrow] = [wide, narrow].map(|svg| inline(svg, title));
        let remark = escaped(remark);
        let charts =
            format!("<div class=\"broad\">{wide}</div>\n<div class=\"slim\">{narrow}</div>");
        let caption = format!("<figcaption class=\"soft\">{remark}</figcaption>");
        self.element("<figure>\n", &format!("{charts}\n{caption}\n"), "</figure>");
    }

    /// Pictures side by side as far as there is room.
    pub fn pictures(&mut self, pictures: &[Picture]) {
        let pictures: String = pictures.iter().map(Picture::html).collect();
        self.element("<div class=\"grid\">\n", &pictures, "</div>");
    }

    /// A long text that is shown on demand.
    pub fn folded(&mut self, title: &str, text: &str) {
        let title = escaped(title);
        let opening = format!("<details><summary>{title}</summary>\n<pre>");
        self.element(&opening, &escaped(text), "</pre></details>");
    }

    /// The document.
    pub fn into_html(self) -> String {
        self.text + "</body>\n</html>\n"
    }
}

/// A table of texts.
#[derive(Debug, Clone, Default)]
pub struct Table {
    head: String,
    rows: String,
}

impl Table {
    /// A table with the names of its columns; those of numbers end in `#`.
    pub fn new(columns: &[&str]) -> Self {
        let head = columns.iter().map(|name| match name.strip_suffix('#') {
            Some(name) => format!("<th class=\"number\">{}</th>", escaped(name)),
            None => format!("<th>{}</th>", escaped(name)),
        });
        Self {
            head: head.collect(),
            rows: String::new(),
        }
    }

    /// Adds a row; the first cells are text, the others, as many as `numbers`, are numbers.
    pub fn row(&mut self, texts: &[&str], numbers: &[String]) {
        self.rows.push_str("<tr>");
        for text in texts {
            let _ = write!(self.rows, "<td>{}</td>", escaped(text));
        }
        for number in numbers {
            let _ = write!(self.rows, "<td class=\"number\">{}</td>", escaped(number));
        }
        self.rows.push_str("</tr>\n");
    }

    /// Adds a row that stands out, as [`Self::row`].
    pub fn best_row(&mut self, texts: &[&str], numbers: &[String]) {
        let start = self.rows.len();
        self.row(texts, numbers);
        self.rows
            .replace_range(start..start + 4, "<tr class=\"best\">");
    }

    /// Adds a row that says why so many other columns have no value.
    pub fn failed_row(&mut self, texts: &[&str], why: &str, columns: usize) {
        self.row(texts, &[]);
        self.rows.truncate(self.rows.len() - "</tr>\n".len());
        let why = escaped(why);
        let _ = writeln!(
            self.rows,
            "<td class=\"failed\" colspan=\"{columns}\">{why}</td></tr>"
        );
    }

    fn html(&self) -> String {
        let Self { head, rows } = self;
        format!("<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n")
    }
}

/// A chart as part of a page.
fn inline(svg: &str, title: &str) -> String {
    let svg = svg
        .split_once("<svg ")
        .map_or("", |(_, rest)| rest.trim_end());
    let named = format!("<svg role=\"img\" aria-label=\"{}\" ", escaped(title));
    named + &svg.replace(INK, "\"currentColor\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAD: &str = "</title><script>alert('1')</script>&\"\u{1b}[2J";

    #[test]
    fn nothing_that_is_put_into_a_page_is_markup() {
        let mut page = Page::new(BAD, BAD);
        page.heading(BAD);
        page.text(BAD);
        page.remark(BAD);
        page.warning(BAD);
        page.list([BAD]);
        page.terms(&[(BAD, BAD.into())]);
        let mut table = Table::new(&[BAD, "value#"]);
        table.row(&[BAD], &[BAD.into()]);
        table.best_row(&[BAD], &[BAD.into()]);
        table.failed_row(&[BAD], BAD, 1);
        page.table(&table);
        page.charts([(BAD, "<svg width=\"1\"></svg>".to_owned())]);
        page.chart(BAD, ["<svg width=\"1\"></svg>"; 2], BAD);
        page.folded(BAD, BAD);
        let html = page.into_html();
        assert!(
            !html.contains("<script") && !html.contains('\u{1b}'),
            "{html}"
        );
        assert_eq!(html.matches("&lt;script&gt;").count(), 23);
        for tag in [
            "title", "dl", "ul", "table", "div", "figure", "details", "pre", "body",
        ] {
            let of = |sign: &str| html.matches(&format!("<{sign}{tag}")).count();
            assert_eq!(of(""), of("/"), "{tag}");
        }
    }

    #[test]
    fn a_page_is_known_by_its_maker() {
        let html = Page::new("a", "Kluft run").into_html();
        assert!(Page::is_by(&html, "Kluft run"));
        assert!(!Page::is_by(&html, "Kluft study"));
        let quoted =
            "<!DOCTYPE html>\n<p>\n<p>\n<p>\n<p>\n<p>\n<meta name=\"generator\" content=\"a\"/>";
        assert!(!Page::is_by(quoted, "a"));
    }

    #[test]
    fn charts_take_the_colour_of_text() {
        let svg = "<?xml version=\"1.0\"?>\n<svg width=\"5\"><path stroke=\"#808080\"/></svg>\n";
        let html = inline(svg, "a < b");
        let named = "<svg role=\"img\" aria-label=\"a &lt; b\" width=\"5\">";
        assert_eq!(
            html,
            format!("{named}<path stroke=\"currentColor\"/></svg>")
        );
    }
}
