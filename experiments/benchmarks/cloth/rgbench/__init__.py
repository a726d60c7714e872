"""RGBench (AAAI 2026, github.com/hwk0809/RGBench): whole garments, real point clouds against simulated vertices.

Its data (huggingface.co/datasets/hwk0809/RGBench-Cloth-Sim2Real-v1, CC-BY 4.0) are not shipped. Who has them runs
``python -m experiments.benchmarks.cloth.rgbench``, or RGBench's own runner with :class:`.environment.Environment`.
"""
