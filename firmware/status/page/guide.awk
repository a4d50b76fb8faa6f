# Makes a page for a browser of what cmark-gfm makes of a page of the operating guide: headings that
# links find, and links to the pages beside it. `before` stands before each of these.
#   cmark-gfm -e table nodes.md | awk -v before= -f guide.awk > nodes.html

# As a heading is linked to: small, without marks, a hyphen for each space.
function anchor(text) {
  gsub(/<[^>]*>|&[a-z]+;/, "", text)
  text = tolower(text)
  gsub(/[^a-z0-9_ -]/, "", text)
  gsub(/ /, "-", text)
  return text
}

function plain(text) {
  gsub(/<[^>]*>/, "", text)
  return text
}

{
  if (match($0, /^<h[1-6]>/)) {
    if (title == "") title = plain($0)
    sub(/>/, " id=\"" anchor($0) "\">")
  }
  # What is beside the guide is not served.
  while (match($0, /<a href="\.\.\/[^"]*">[^<]*<\/a>/)) {
    $0 = substr($0, 1, RSTART - 1) plain(substr($0, RSTART, RLENGTH)) substr($0, RSTART + RLENGTH)
  }
  gsub(/\.md"/, ".html\"")
  gsub(/\.md#/, ".html#")
  # A name of a page in the text is that of its file.
  gsub(/\.md<\/a>/, "</a>")
  gsub(/(href|src)="/, "&" before)
  # What is no page of the guide stays what it was.
  if (before != "") {
    gsub("\"" before "#", "\"#")
    gsub("\"" before "http:", "\"http:")
    gsub("\"" before "https:", "\"https:")
  }
  text = text $0 "\n"
}

END {
  print "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">"
  print "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
  print "<meta name=\"color-scheme\" content=\"light dark\">"
  print "<title>" title "</title>\n<link rel=\"icon\" href=\"" (before == "" ? "../" : "") "icon.svg\">"
  print "<link rel=\"stylesheet\" href=\"" before "guide.css\">"
  print "</head>\n<body>"
  print "<p><a href=\"" (before == "" ? "../" : "./") "\">Status</a>"
  print "| <a href=\"" before "README.html\">Guide</a></p>"
  printf "%s", text
  print "</body>\n</html>"
}
