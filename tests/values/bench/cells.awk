# The rows of a table by their titles: heads($0) takes the titles, cells($0) fills cell[TITLE]. Of a cell of several
# words phrase[TITLE] is what it must be. A title that stands twice has its neighbour's before it. Tables that are not
# --wide fit 80 columns (-v wide=1: all columns are there).
function heads(line,  c) {
    columns = split(line, title, " ")
    for (c = 2; c <= columns; c++)
        if (title[c] == "least-most") title[c] = title[c - 1] " least-most"
}
function cells(text,  c, is) {
    delete cell
    for (c = 1; c <= columns; c++) {
        sub(/^ */, "", text)
        is = title[c] in phrase ? phrase[title[c]] : text
        if (title[c] in phrase) truth("column " title[c] ", " text ", is not " is, index(text " ", is " ") == 1)
        else sub(/ .*/, "", is)
        cell[title[c]] = is
        text = substr(text, length(is) + 1)
    }
    sub(/ *$/, "", text)
    equal("behind the last column", text, "")
}
function number(name, column, format, is) { if (column in cell) same(name column, cell[column], format, is) }
function says(name, column, is) { if (column in cell) equal(name column, cell[column], is) }
function span(name, column, format, least, most) { if (column in cell) same_span(name column, cell[column], format, least, most) }
FNR > 1 && FILENAME ~ /text$/ && !wide && !/^written: / && length($0) > 80 { bad("longer than 80 columns: " $0) }
