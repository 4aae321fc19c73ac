"""Kernels of linear trees and of the meshes made from them."""
