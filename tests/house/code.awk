# The code of C and GLSL files, line by line, without comments: awk -f tests/house/code.awk FILE...
# Of strings the quotes alone with -v empty=1; "FILE:LINE: " before each line with -v placed=1.
FNR == 1 { comment = 0 }
{
    line = $0
    kept = ""
    if (empty) gsub(/"([^"\\]|\\.)*"/, "\"\"", line)
    while (line != "") {
        if (comment) {
            end = index(line, "*/")
            if (!end) break
            line = substr(line, end + 2)
            comment = 0
        }
        begin = index(line, "/*")
        if (!begin) { kept = kept line; break }
        kept = kept substr(line, 1, begin - 1)
        line = substr(line, begin + 2)
        comment = 1
    }
    print (placed ? FILENAME ":" FNR ": " : "") kept
}
