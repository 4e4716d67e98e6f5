"""lbmpy's generated C kernels: in place (AA pattern), multiple relaxation times, OpenMP, vectorised."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np


def lbmpy_steps(n: int, dtype, threads: int) -> dict[str, Callable[[], None]]:
    """Per instruction set, a function that makes an even and an odd step of n^3 cells; empty without lbmpy.

    The kernels run over the cells alone: without the exchange of ghost layers that periodic faces would need.
    """
    try:
        import pystencils as ps
        from lbmpy import LBMConfig, LBMOptimisation, LBStencil, Method, Stencil, create_lb_update_rule
        from lbmpy.advanced_streaming import Timestep
    except ImportError:
        return {}
    name = np.dtype(dtype).name
    field = ps.fields(f"f(19): {name}[3D]", layout="fzyx")
    populations = np.zeros((19, n + 2, n + 2, n + 2), dtype).transpose(3, 2, 1, 0)
    steps = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for target in (ps.Target.X86_AVX512, ps.Target.X86_AVX):
            if target not in ps.Target.available_targets():
                continue
            kernels = []
            for timestep in (Timestep.EVEN, Timestep.ODD):
                method = LBMConfig(
                    stencil=LBStencil(Stencil.D3Q19),
                    method=Method.MRT,
                    relaxation_rates=[1.7, 1.19, 1.4, 1.2, 1.4, 1.98],
                    compressible=True,
                    zero_centered=True,
                    streaming_pattern="aa",
                    timestep=timestep,
                )
                rule = create_lb_update_rule(
                    lbm_config=method, lbm_optimisation=LBMOptimisation(symbolic_field=field, cse_global=True)
                )
                config = ps.CreateKernelConfig(default_dtype=name, target=target, ghost_layers=1)
                config.cpu.openmp.enable = True
                config.cpu.openmp.num_threads = threads
                config.cpu.vectorize.enable = True
                config.cpu.vectorize.assume_inner_stride_one = True
                kernels.append(ps.create_kernel(rule, config).compile())

            def step(kernels=kernels):
                for kernel in kernels:
                    kernel(f=populations)

            steps[f"lbmpy {target.name[4:]}"] = step
    return steps
