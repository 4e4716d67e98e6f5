"""Collision of one cell: multiple relaxation times, written once and inlined by every kernel.

In moment space (d'Humieres et al., Phil. Trans. R. Soc. A 360 (2002) 437)::

    m* = m - S (m - m_eq) + (I - S/2) M F,      f* = f + M^T N^-1 (m* - m),   N = diag(M M^T)

with the second-order equilibrium and Guo's force (Guo, Zheng & Shi, Phys. Rev. E 65 (2002) 046308), whose
velocity is ``rho u = sum_k c_k f_k + F/2``.  Because the rows of M are orthogonal, the product with M splits
by symmetry: the sums of opposite populations carry the even moments, their differences the odd ones, and
within the even ones the shells |c|^2 = 0, 1, 2 carry the scalars.  The code below is that split; the tests
compare it with the dense product by the matrix of :mod:`lbm.fluid.moments`.

Populations are deviations ``f_k - w_k`` from a fluid at rest of density 1, so ``rho = 1 + sum_k f_k``.
"""

from __future__ import annotations

from numba.extending import intrinsic

from lbm.fluid.cache import inlined


@intrinsic
def like(typingctx, value, x):
    """``value`` in the floating-point type of ``x``: keeps single precision single."""

    def codegen(context, builder, signature, args):
        return context.cast(builder, args[0], signature.args[0], signature.return_type)

    return x(value, x), codegen


@inlined
def collide(f, rates, force):
    """Populations after collision.

    Parameters: ``f`` 19 populations (deviations, order of :data:`lbm.fluid.stencil.C`); ``rates`` the tuple of
    :meth:`lbm.rates.Rates.scaled` (relaxation rates over the squared norms of their moments); ``force`` the
    force density (F_x, F_y, F_z), or None, which leaves the terms of the force out of the compiled code.
    """
    r_e, r_eps, r_q, r_p, r_w, r_s, r_pip, r_piw, r_m, h_e, h_eps, h_q, h_p, h_w, h_s, h_pip, h_piw, h_j = rates
    r, xp, xm, yp, ym, zp, zm, ap, am, bp, bm, cp, cm, dp, dm, ep, em, gp, gm = f
    one, two, three, four = like(1, r), like(2, r), like(3, r), like(4, r)
    eight, eleven, twelve, thirty = like(8, r), like(11, r), like(12, r), like(30, r)
    half, two_thirds = like(0.5, r), like(2.0 / 3.0, r)

    # sums of opposite populations: axes, then the two diagonals of each plane
    sx, sy, sz = xp + xm, yp + ym, zp + zm
    sa, sb, sc, sd, se, sg = ap + am, bp + bm, cp + cm, dp + dm, ep + em, gp + gm
    sxy, sxz, syz = sa + sb, sc + sd, se + sg
    pxy, pxz, pyz = sa - sb, sc - sd, se - sg
    axes, diagonals = sx + (sy + sz), sxy + (sxz + syz)
    drho = r + (axes + diagonals)

    # differences
    ox, oy, oz = xp - xm, yp - ym, zp - zm
    oa, ob, oc, od, oe, og = ap - am, bp - bm, cp - cm, dp - dm, ep - em, gp - gm
    x_xy, x_xz = oa + ob, oc + od
    y_xy, y_yz = oa - ob, oe + og
    z_xz, z_yz = oc - od, oe - og
    tx, ty, tz = x_xy + x_xz, y_xy + y_yz, z_xz + z_yz
    jx, jy, jz = ox + tx, oy + ty, oz + tz
    if force is not None:
        fx, fy, fz = force
        jx, jy, jz = jx + half * fx, jy + half * fy, jz + half * fz
    over_rho = one / (one + drho)
    ux, uy, uz = jx * over_rho, jy * over_rho, jz * over_rho
    kx, ky, kz = jx * ux, jy * uy, jz * uz
    kk = kx + (ky + kz)

    # even moments: distance to equilibrium times rate over squared norm
    e = thirty * r + eleven * axes - eight * diagonals
    eps = four * axes - twelve * r - diagonals
    m_e = r_e * (e - eleven * drho + (eight + eleven) * kk)
    m_eps = r_eps * (eps + three * drho - (four + half + one) * kk)
    a_x, d_x = two * sx - (sy + sz), (sxy + sxz) - two * syz
    a_w, d_w = sy - sz, sxy - sxz
    q_x, q_w = two * kx - (ky + kz), ky - kz
    m_p = r_p * (q_x - (a_x + d_x))
    m_pip = r_pip * (two * a_x - d_x - half * q_x)
    m_w = r_w * (q_w - (a_w + d_w))
    m_piw = r_piw * (two * a_w - d_w - half * q_w)
    m_xy, m_xz, m_yz = r_s * (jx * uy - pxy), r_s * (jx * uz - pxz), r_s * (jy * uz - pyz)
    if force is not None:
        gx, gy, gz = ux * fx, uy * fy, uz * fz
        g = gx + (gy + gz)
        g_x, g_w = two * gx - (gy + gz), gy - gz
        m_e += h_e * g
        m_eps -= h_eps * g
        m_p += h_p * g_x
        m_pip -= h_pip * g_x
        m_w += h_w * g_w
        m_piw -= h_piw * g_w
        m_xy += h_s * (ux * fy + uy * fx)
        m_xz += h_s * (ux * fz + uz * fx)
        m_yz += h_s * (uy * fz + uz * fy)

    # odd moments
    q_jx = r_q * (four * ox - tx - two_thirds * jx)
    q_jy = r_q * (four * oy - ty - two_thirds * jy)
    q_jz = r_q * (four * oz - tz - two_thirds * jz)
    w_x, w_y, w_z = r_m * (x_xz - x_xy), r_m * (y_xy - y_yz), r_m * (z_yz - z_xz)
    if force is not None:
        q_jx -= h_q * fx
        q_jy -= h_q * fy
        q_jz -= h_q * fz
        jx, jy, jz = h_j * fx, h_j * fy, h_j * fz
        n_x, n_y, n_z = jx - four * q_jx, jy - four * q_jy, jz - four * q_jz
        q_jx, q_jy, q_jz = q_jx + jx, q_jy + jy, q_jz + jz
    else:
        n_x, n_y, n_z = -four * q_jx, -four * q_jy, -four * q_jz

    # back to populations
    scalar_1 = -eleven * m_e - four * m_eps
    scalar_2 = eight * m_e + m_eps
    ax, aw = m_p - two * m_pip, m_w - two * m_piw
    dx, dw = m_p + m_pip, m_w + m_piw
    e_x, e_y, e_z = scalar_1 + two * ax, scalar_1 - ax + aw, scalar_1 - ax - aw
    e_xy, e_xz, e_yz = scalar_2 + dx + dw, scalar_2 + dx - dw, scalar_2 - two * dx
    x_plus, x_minus = q_jx + w_x, q_jx - w_x
    y_plus, y_minus = q_jy + w_y, q_jy - w_y
    z_plus, z_minus = q_jz + w_z, q_jz - w_z
    e_a, e_b, o_a, o_b = e_xy + m_xy, e_xy - m_xy, x_plus + y_minus, x_plus - y_minus
    e_c, e_d, o_c, o_d = e_xz + m_xz, e_xz - m_xz, x_minus + z_plus, x_minus - z_plus
    e_e, e_g, o_e, o_g = e_yz + m_yz, e_yz - m_yz, y_plus + z_minus, y_plus - z_minus
    return (
        r - thirty * m_e + twelve * m_eps,
        xp + (e_x + n_x), xm + (e_x - n_x),
        yp + (e_y + n_y), ym + (e_y - n_y),
        zp + (e_z + n_z), zm + (e_z - n_z),
        ap + (e_a + o_a), am + (e_a - o_a), bp + (e_b + o_b), bm + (e_b - o_b),
        cp + (e_c + o_c), cm + (e_c - o_c), dp + (e_d + o_d), dm + (e_d - o_d),
        ep + (e_e + o_e), em + (e_e - o_e), gp + (e_g + o_g), gm + (e_g - o_g),
    )  # fmt: skip
