# A tracer in awk (double precision): raydiff gen sphere:n=8 --decimal | awk -f this | raydiff verify
# Each line of a request begins with its kind; see raydiff gen --help.
BEGIN { vertices = triangles = 0 }
# Hexadecimal floats, of which not every awk knows.
function number(text,    part, sign, value, dot, i) {
    if (text !~ /0x/) return text + 0
    sign = text ~ /^-/ ? -1 : 1
    sub(/^[-+]?0x/, "", text)
    split(text, part, "p")
    value = dot = 0
    for (i = 1; i <= length(part[1]); i++)
        if (substr(part[1], i, 1) == ".") dot = i
        else value = value * 16 + index("0123456789abcdef", substr(part[1], i, 1)) - 1
    return sign * value * 2 ^ (part[2] - (dot ? 4 * (length(part[1]) - dot) : 0))
}
$1 == "raydiff" && $2 != 1 { print "refused this tracer takes scenes alone"; exit }
$1 == "from" { print }
$1 == "v" { for (k = 0; k < 3; k++) vertex[vertices, k] = number($(k + 2)); vertices++ }
$1 == "t" {
    for (k = 0; k < 3; k++) {
        a[triangles, k] = vertex[$2, k]
        e[triangles, k] = vertex[$3, k] - vertex[$2, k]
        f[triangles, k] = vertex[$4, k] - vertex[$2, k]
    }
    triangles++
}
$1 == "r" {
    for (k = 2; k <= 9; k++) r[k] = number($k) # origin, tmin, direction, tmax
    best = -1
    t_best = r[9]
    for (i = 0; i < triangles; i++) { # Moeller and Trumbore 1997
        px = r[7] * f[i, 2] - r[8] * f[i, 1]; py = r[8] * f[i, 0] - r[6] * f[i, 2]; pz = r[6] * f[i, 1] - r[7] * f[i, 0]
        det = e[i, 0] * px + e[i, 1] * py + e[i, 2] * pz
        if (det == 0) continue
        sx = r[2] - a[i, 0]; sy = r[3] - a[i, 1]; sz = r[4] - a[i, 2]
        u = (sx * px + sy * py + sz * pz) / det
        if (u < 0 || u > 1) continue
        qx = sy * e[i, 2] - sz * e[i, 1]; qy = sz * e[i, 0] - sx * e[i, 2]; qz = sx * e[i, 1] - sy * e[i, 0]
        v = (r[6] * qx + r[7] * qy + r[8] * qz) / det
        t = (f[i, 0] * qx + f[i, 1] * qy + f[i, 2] * qz) / det
        if (v < 0 || u + v > 1 || t < r[5] || t > t_best) continue
        best = i; t_best = t; u_best = u; v_best = v
    }
    if (best < 0) print "m"
    else printf "h %.9g %.9g %.9g %d\n", t_best, u_best, v_best, best
}
