# /// script
# dependencies = ["kinopt[torch]"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""Inverse kinematics as a layer of PyTorch: gradient descent moves a target until the elbow has a wanted angle."""

import torch

import kinopt
import kinopt.torch

arm = kinopt.Arm(kinopt.models.ur5e(), "base", "flange")
start = torch.tensor([0.3, -1.1, 1.0, -0.9, 1.1, 0.4], dtype=torch.float64)
pose = torch.tensor(arm.base_from_tool(start.numpy()))
offset = torch.zeros(3, dtype=torch.float64, requires_grad=True)  # metres
optimiser = torch.optim.Adam([offset], lr=0.01)
for step in range(200):
    target = pose.clone()
    target[:3, 3] = pose[:3, 3] + offset
    q = kinopt.torch.solve(arm, target, start)
    loss = (q[2] - 1.5) ** 2  # the elbow, radians
    optimiser.zero_grad()
    loss.backward()
    optimiser.step()
print(f"elbow {q[2].item():.3f} rad, target moved by {offset.detach().numpy().round(3)} m")
assert abs(q[2].item() - 1.5) < 1e-2
