"""The Haply 2DIY: a planar five-bar linkage on a serial port."""
