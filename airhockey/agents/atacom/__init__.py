"""ATACOM: any policy acts on the tangent space of the constraints (Liu et al., CoRL 2021 and T-RO 2024)."""
