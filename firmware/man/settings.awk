# Makes the manual page of the settings from the operating guide, whose table is that of
# settings_keys.cpp (a test compares them): awk -f settings.awk settings.md > gateway.toml.5

# What troff would take for a request, or mdoc for more than text.
function escaped(text) {
  gsub(/\\\|/, "|", text)
  gsub(/\\/, "\\e", text)
  gsub(/-/, "\\-", text)
  return text
}

# `code` in bold, **strong** and [links](to) as plain text.
function running(text, part, i, made) {
  gsub(/\*\*/, "", text)
  while (match(text, /\[[^][]*\]\([^)]*\)/)) {
    made = substr(text, RSTART + 1, RLENGTH - 1)
    sub(/\]\(.*/, "", made)
    text = substr(text, 1, RSTART - 1) made substr(text, RSTART + RLENGTH)
  }
  made = ""
  i = split(text, part, "`")
  for (i = 1; i in part; ++i) {
    if (i > 1) made = made (i % 2 == 0 ? "\\fB" : "\\fR")
    made = made escaped(part[i])
  }
  return made
}

function trimmed(text) {
  gsub(/^ +| +$/, "", text)
  return text
}

# Text, each sentence on a line of its own; a leading . or ' would be a request.
function say(text, sentence, count, i) {
  if (text == "") return
  count = split(text, sentence, /\. /)
  for (i = 1; i <= count; ++i) {
    print (sentence[i] ~ /^[.']/ ? "\\&" : "") sentence[i] (i < count ? "." : "")
  }
}

function open_list() {
  if (!is_open) print ".Bl -tag -width Ds"
  is_open = 1
}

function close_list() {
  if (is_open) print ".El"
  is_open = 0
}

BEGIN {
  print ".Dd November 21, 2026"
  print ".Dt GATEWAY.TOML 5"
  print ".Os"
  print ".Sh NAME"
  print ".Nm gateway.toml"
  print ".Nd settings of etcm-gateway"
  print ".Sh SYNOPSIS"
  print ".Pa /etc/etcm/gateway.toml"
  print ".Sh DESCRIPTION"
  print "What the gateway collects, keeps and publishes."
  print "Every mistake in it is told with its line and the cure by"
  print ".Ic etcm\\-gateway \\-\\-config gateway.toml \\-\\-check\\-config ."
}

/^# Settings/ { inside = 1; next }
inside && /^## / { inside = 0 }
!inside { next }

/^\| key / || /^\|---/ { was_table = 1; next }
/^\|/ {
  # A | inside of code is written as \|.
  row = $0
  gsub(/\\\|/, "\001", row)
  split(row, cell, "|")
  for (i in cell) gsub(/\001/, "|", cell[i])
  key = running(trimmed(cell[2])); unit = running(trimmed(cell[3]))
  standard = running(trimmed(cell[4])); reload = trimmed(cell[5])
  meaning = running(trimmed(cell[6]))
  ++rows
  is_paragraph = 0
  if (cell[2] ~ /\*\*/) {
    close_list()
    print ".Ss " key
    if (standard == "required") {
      say("Required.")
    } else if (standard != "") {
      say((cell[2] ~ /\[\[/ ? "Given: " : "Without it: ") standard ".")
    }
    say(meaning == "" ? "" : toupper(substr(meaning, 1, 1)) substr(meaning, 2) ".")
    next
  }
  open_list()
  print ".It " key (unit == "" ? "" : "    " unit)
  say(meaning == "" ? "" : toupper(substr(meaning, 1, 1)) substr(meaning, 2) ".")
  if (standard == "required") {
    say("Required.")
  } else {
    say("Default: " (standard == "" ? "none" : standard) ".")
  }
  say(reload == "at once" ? "Changes at a reload." : reload == "additions" ? \
      "A reload adds to it; any other change needs a restart." : "Needs a restart.")
  next
}
{
  if ($0 == "") {
    is_paragraph = 1
    next
  }
  close_list()
  if (is_paragraph) print ".Pp"
  is_paragraph = 0
  say(running($0))
}

END {
  close_list()
  print ".Sh FILES"
  print ".Bl -tag -width Ds"
  print ".It Pa /etc/etcm/gateway.toml"
  print "What the service reads."
  print ".El"
  print ".Sh EXAMPLES"
  print "Ten nodes behind a converter, one of which has a name, a fence between two of them, and the page:"
  print ".Bd -literal"
  print "[mesh]\nvertices_max = 100\nfeatures_max = 10\n"
  print "[[bus]]\nname = \"yard\"\ntcp = \"192.0.2.5:502\"\nunits = \"1\\-10\"\n"
  print "[[node]]\nserial = 1001\nname = \"pump house\"\n"
  print "[[feature]]\nfrom = 1001\nto = 1002\nname = \"north fence\"\n"
  print "[http]\nlisten = \"127.0.0.1:8080\""
  print ".Ed"
  print ".Pp"
  print "Whether all of it is right:"
  print ".Pp"
  print ".Dl etcm\\-gateway \\-\\-config /etc/etcm/gateway.toml \\-\\-check\\-config"
  print ".Sh SEE ALSO"
  print ".Xr etcm-bus 1 ,"
  print ".Xr etcm-gateway 8"
  if (rows == 0) {
    print "settings.awk: there is no table under '# Settings'" > "/dev/stderr"
    exit 1
  }
}
