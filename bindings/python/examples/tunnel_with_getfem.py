"""A tunnel in Mohr-Coulomb ground, plane strain, with the finite elements of GetFEM (python3-getfem) and the law `talus.Law` at
their integration points. Prints the largest difference from the closed-form solution; exit code 1 if it exceeds 0.1 % of p_0.

A thick cylinder, inner radius r_i = 1 m, outer radius r_o = 5 m, is under the pressure p_0 = 1 MPa inside and outside; the inner
pressure falls to p_i. The ground around the opening yields up to the radius R. With N = (1 + sin phi)/(1 - sin phi), a = c cot phi:

    r < R:  sigma_r = (p_i + a) (r/r_i)^(N-1) - a,   sigma_t = N (sigma_r + a) - a
    r > R:  sigma_r = A - B/r^2,  sigma_t = A + B/r^2,  sigma_r(r_o) = p_0

in pressures (Salencon 1969, Contraction quasi-statique d'une cavite). B follows from sigma_r(R), R from yield at R.
"""

import math
import sys

import getfem as gf
import numpy as np
import talus

r_i, r_o, p_0, p_i = 1.0, 5.0, 1e6, 0.05e6
c, phi = 0.1e6, math.radians(30)
law = talus.Law("mohr_coulomb", E="100 MPa", nu=0.3, c="100 kPa", phi="30 deg", psi="0 deg")
n_r, n_t, n_steps = 16, 4, 19


def mesh_of_a_quarter():
    """Curved quadrilaterals of nine nodes, whose size grows with the radius."""
    mesh = gf.Mesh("empty", 2)
    shares, angles = np.linspace(0, 1, 2 * n_r + 1), np.linspace(0, math.pi / 2, 2 * n_t + 1)
    radii = r_i * (r_o / r_i) ** shares
    for i in range(0, 2 * n_r, 2):
        for j in range(0, 2 * n_t, 2):
            t, r = np.meshgrid(angles[j:j + 3], radii[i:i + 3], indexing="ij")  # nodes along the radius first
            mesh.add_convex(gf.GeoTrans("GT_QK(2,2)"), np.array([(r * np.cos(t)).ravel(), (r * np.sin(t)).ravel()]))
    return mesh


def analytical(r):
    """sigma_r and sigma_t, compression-positive."""
    N, a = (1 + math.sin(phi)) / (1 - math.sin(phi)), c / math.tan(phi)
    inside = lambda r: (p_i + a) * (r / r_i) ** (N - 1) - a

    def A_and_B(R):  # Lame: sigma_r(R) = inside(R), sigma_r(r_o) = p_0
        B = (p_0 - inside(R)) / (1 / R**2 - 1 / r_o**2)
        return p_0 + B / r_o**2, B

    def excess(R):  # over yield, just outside R
        A, B = A_and_B(R)
        return (A + B / R**2 + a) - N * (A - B / R**2 + a)

    low, high = r_i, r_o * (1 - 1e-9)
    for _ in range(200):
        R = 0.5 * (low + high)
        low, high = (R, high) if excess(R) > 0 else (low, R)
    A, B = A_and_B(R)
    radial = np.where(r < R, inside(r), A - B / r**2)
    return radial, np.where(r < R, N * (radial + a) - a, A + B / r**2), R


mesh = mesh_of_a_quarter()
edges = mesh.outer_faces()
points = mesh.pts()
sides = {"inner": [], "x_axis": [], "y_axis": [], "outer": []}
for element, face in edges.T:
    px, py = points[:, mesh.pid_in_faces(np.array([[element], [face]]))]
    r = np.hypot(px, py)
    key = "x_axis" if abs(py).max() < 1e-9 else "y_axis" if abs(px).max() < 1e-9 else "inner" if r.max() < 1.001 * r_i else "outer"
    sides[key].append((element, face))
number = {key: i + 1 for i, key in enumerate(sides)}
for key, faces in sides.items():
    mesh.set_region(number[key], np.array(faces).T)

displacement = gf.MeshFem(mesh, 2)
displacement.set_fem(gf.Fem("FEM_Q2_INCOMPLETE(2)"))  # eight nodes
integration = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))  # two points a direction
stresses = gf.MeshImData(integration, -1, [2, 2])
tangents = gf.MeshImData(integration, -1, [2, 2, 2, 2])
model = gf.Model("real")
model.add_fem_variable("u", displacement)
model.add_fem_data("step", displacement)
model.add_im_data("sigma", stresses)
model.add_im_data("C", tangents)
n_points = stresses.nbpts()
coordinates = model.interpolation("X", gf.MeshImData(integration, -1, [2])).reshape(n_points, 2)
radius = np.hypot(*coordinates.T)

state = law.initial_state(pressure=np.full(n_points, p_0))
in_plane = [[0, 3], [3, 1]]  # places of xx, xy, yy in xx yy zz xy yz zx


def pass_on(stress, tangent):
    """Passes stresses and tangents; GetFEM's arrays are column-major at each point."""
    model.set_variable("sigma", stress[:, in_plane].transpose(0, 2, 1).reshape(-1))
    at = np.array(in_plane)
    C = tangent[:, at[:, :, None, None], at[None, None, :, :]]
    model.set_variable("C", C.transpose(0, 4, 3, 2, 1).reshape(-1))


def strains(u):
    """Strain increments at the integration points, shape (points, 6)."""
    model.set_variable("step", u)
    g = model.interpolation("Grad_step", stresses).reshape(n_points, 2, 2)
    e = np.zeros((n_points, 6))
    e[:, 0], e[:, 1], e[:, 3] = g[:, 0, 0], g[:, 1, 1], 0.5 * (g[:, 0, 1] + g[:, 1, 0])
    return e


def assembled(order, expression, region=-1):
    return gf.asm_generic(integration, order, expression, region, model)


fixed = np.zeros(displacement.nbdof(), bool)
for side, component in (("x_axis", 1), ("y_axis", 0)):
    dofs = displacement.basic_dof_on_region(number[side])
    fixed[dofs[dofs % 2 == component]] = True
free = np.flatnonzero(~fixed)
outer = p_0 * assembled(1, "-Test_u.Normal", number["outer"])
inner = assembled(1, "-Test_u.Normal", number["inner"])

def moved(u, load):
    """States and stresses after the displacement u of this step, and the forces that are not balanced."""
    trial = state.copy()
    step = law.update(trial, strains(u), dt=1.0, tangent=True)
    pass_on(step.stress, step.tangent)
    return trial, step, (assembled(1, "sigma:Grad_Test_u") - load)[free]


for k in range(1, n_steps + 1):
    load = outer + (p_0 + (p_i - p_0) * k / n_steps) * inner
    u, iterations = np.zeros(displacement.nbdof()), 0
    trial, step, residual = moved(u, load)
    while np.abs(residual).max() > 1e-8 * np.abs(load).max():
        if (iterations := iterations + 1) > 30:
            sys.exit(f"step {k} does not converge")
        K = assembled(2, "(C:Grad_Test2_u):Grad_Test_u").full()[np.ix_(free, free)]
        change, old, at_start = np.linalg.solve(K, -residual), np.linalg.norm(residual), u.copy()
        for share in (1, 0.5, 0.25, 0.125):  # Newton's change, or less of it until the forces decrease
            u[free] = at_start[free] + share * change
            trial, step, residual = moved(u, load)
            if np.linalg.norm(residual) < old:
                break
    state = trial
    print(f"step {k}: {iterations} iterations, {np.mean(step.outcome == 1):.0%} of the points yield")

stress = law.stress(state)
normal = coordinates / radius[:, None]
radial = -(stress[:, 0] * normal[:, 0]**2 + 2 * stress[:, 3] * normal[:, 0] * normal[:, 1] + stress[:, 1] * normal[:, 1]**2)
hoop = -(stress[:, 0] + stress[:, 1]) - radial
expected_radial, expected_hoop, R = analytical(radius)
error = max(np.abs(radial - expected_radial).max(), np.abs(hoop - expected_hoop).max()) / p_0
print(f"plastic radius {R:.3f} m; largest error of the stress at the integration points: {100 * error:.3f} % of p_0")
sys.exit(0 if error < 1e-3 else 1)
