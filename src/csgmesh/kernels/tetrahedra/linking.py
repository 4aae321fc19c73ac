"""Machine code that is compiled once and called by name from that of other kernels."""

from __future__ import annotations

import llvmlite.binding
from llvmlite import ir
from numba import cfunc, types
from numba.core import cgutils

from ..pointers import ENTRY, JIT_IS_OFF


def name_function(name, function, n):
    """Compile a function of n doubles that returns one, and give it a name."""
    if JIT_IS_OFF:
        return
    double = types.float64
    compiled = cfunc(double(*[double] * n), **ENTRY)(function.py_func)
    llvmlite.binding.add_symbol(name, compiled.address)


def call_by_name(name, n):
    """Signature and code generator of an intrinsic that calls a named function of n doubles."""

    def codegen(context, builder, sig, args):
        double = ir.DoubleType()
        kind = ir.FunctionType(double, [double] * n)
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), args)

    return types.float64(*[types.float64] * n), codegen
