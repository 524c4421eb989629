"""Transient sliding in scaled form: an equation of motion, two contact edges and their memory."""
