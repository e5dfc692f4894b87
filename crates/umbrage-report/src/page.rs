//! The shell of a page: one HTML file that needs no network and no other file.
//!
//! Takes a title and a body; gives the document with style and script in it. A content security
//! policy lets the browser enforce what is promised: it refuses whatever is not in the file.

/// The document. `body` is HTML: escape what goes into it.
pub fn page(title: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
         img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n{body}\n\
         <script>\n{}</script>\n</body>\n</html>\n",
        escape(title),
        include_str!("page/page.css"),
        include_str!("page/page.js"),
    )
}

/// Text for HTML and SVG, in elements and in quoted attributes.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            other => escaped.push(other),
        }
    }
    escaped
}

/// A command line with a button that copies it; nothing where there is none.
pub(crate) fn command(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    format!(
        "<div class=\"command\"><pre tabindex=\"0\"><code>{}</code></pre>\
         <button type=\"button\" id=\"copy\">Copy</button></div>",
        escape(text)
    )
}

/// Bytes as a `data:` URI (RFC 2397, base64 of RFC 4648).
pub fn data_uri(media_type: &str, bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut uri = format!("data:{media_type};base64,");
    for chunk in bytes.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|k| u32::from(chunk.get(k).copied().unwrap_or(0)));
        let bits = a << 16 | b << 8 | c;
        for digit in 0..4 {
            let used = digit <= chunk.len();
            let value = (bits >> (18 - 6 * digit)) & 63;
            uri.push(if used {
                char::from(DIGITS[value as usize])
            } else {
                '='
            });
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_with_a_meaning_is_escaped() {
        assert_eq!(escape("a<b>&\"'é"), "a&lt;b&gt;&amp;&quot;&#39;é");
    }

    #[test]
    fn base64_of_the_rfc() {
        let of = |text: &str| data_uri("x", text.as_bytes());
        let texts = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(of);
        let wanted = [
            "", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy",
        ];
        assert_eq!(texts, wanted.map(|text| format!("data:x;base64,{text}")));
    }

    #[test]
    fn the_page_loads_nothing() {
        let html = page("t", "");
        for from_elsewhere in ["http://", "https://", "src=", "@import", "url("] {
            assert!(!html.contains(from_elsewhere), "{from_elsewhere}");
        }
    }
}
