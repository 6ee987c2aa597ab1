"""The claims of Thompson, Belnoue and Hallett (2020) on formed parts, each measured on runs of the shipped cases."""
