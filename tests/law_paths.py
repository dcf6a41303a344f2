"""Laws along paths of strain, for tests."""

import numpy as np

from eigencontact.plugin import LawStep


def pulled(law, strains):
    """Stress along x and strain across at axial strains of a path; the other stresses vanish (Newton's method)."""
    place = LawStep(x=np.zeros(1), y=np.zeros(1), z=np.ones(1), time=1.0, duration=1.0)
    before = {name: np.zeros((variable.components, 1)) for name, variable in law.variables.items()}
    strain, path = np.zeros((6, 1)), []
    for axial in strains:
        strain[0] = axial
        for _ in range(60):
            response = law.update(strain, before, place)
            if np.abs(response.stress[1:3]).max() < 1e-4:
                break
            tangent = response.tangent.reshape(6, 6, -1)[1:3, 1:3, 0]
            strain[1:3] -= np.linalg.solve(tangent, response.stress[1:3])
        before = response.variables
        path.append((float(response.stress[0, 0]), float(strain[1, 0])))
    return np.array(path).T, before
