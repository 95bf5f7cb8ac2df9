# An OBJ file of triangles, as `raydiff scene convert` writes it or by hand, kept of files that end with .obj: vertex[],
# corner[]; facts() sets made[].
# True if the corners of triangle t lie on a line or coincide; of simple numbers.
function no_area(t,  k, a, b, u, w_, sum) {
    for (k = 0; k < 3; k++) {
        u[k] = vertex[corner[t, 1], k] - vertex[corner[t, 0], k]
        w_[k] = vertex[corner[t, 2], k] - vertex[corner[t, 0], k]
    }
    for (k = 0; k < 3; k++) {
        a = (k + 1) % 3
        b = (k + 2) % 3
        sum += (u[a] * w_[b] - u[b] * w_[a]) ^ 2
    }
    return sum == 0
}
# The corners' positions, in an order of their own.
function positions(t,  c, i, one, swap) {
    for (c = 0; c < 3; c++) one[c] = vertex[corner[t, c], 0] " " vertex[corner[t, c], 1] " " vertex[corner[t, c], 2]
    for (i = 0; i < 3; i++)
        for (c = 0; c < 2; c++)
            if (one[c] > one[c + 1]) {
                swap = one[c]
                one[c] = one[c + 1]
                one[c + 1] = swap
            }
    return one[0] "," one[1] "," one[2]
}
function facts(  t, c, k, x, lo, hi) {
    made["zero_area"] = made["duplicates"] = made["largest"] = made["longest"] = 0
    for (t = 0; t < triangles; t++) {
        made["zero_area"] += no_area(t)
        made["duplicates"] += seen_before[positions(t)]++ > 0
        for (c = 0; c < 3; c++)
            for (k = 0; k < 3; k++) {
                x = vertex[corner[t, c], k]
                if (t + c == 0 || x < lo[k]) lo[k] = x
                if (t + c == 0 || x > hi[k]) hi[k] = x
                if (x > made["largest"]) made["largest"] = x
                if (-x > made["largest"]) made["largest"] = -x
            }
    }
    for (k = 0; k < 3; k++) {
        made["lo " k] = lo[k]
        made["hi " k] = hi[k]
        if (hi[k] - lo[k] > made["longest"]) made["longest"] = hi[k] - lo[k]
    }
}
FILENAME ~ /\.obj$/ && $1 == "v" {
    for (k = 0; k < 3; k++) vertex[vertices + 0, k] = $(2 + k) + 0
    vertices++
}
FILENAME ~ /\.obj$/ && $1 == "f" {
    for (k = 0; k < 3; k++) corner[triangles + 0, k] = $(2 + k) - 1
    triangles++
}
FILENAME ~ /\.obj$/ { next }
