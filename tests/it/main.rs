//! Capabilities and the command line, one module each, against closed forms and slow, plain
//! references (`support`).

mod support;

mod barely_entered;
mod bodies;
mod check_command;
mod cli;
mod contact;
mod contact_data;
mod contact_pairs;
mod contact_reference;
mod containers;
mod determinism;
mod documents;
mod drawings;
mod dump;
mod entering;
mod entering_times;
mod examples;
mod half_turns;
mod held_out;
mod laws;
mod least_distance;
mod membership;
mod merged_spans;
mod own_axis;
mod planar_command;
mod planar_membership;
mod planar_motion;
mod planar_solid;
mod planar_sweep;
mod proportion;
mod random_scenes;
mod real_parts;
mod refusals;
mod reports;
mod returning_motions;
mod single_precision;
mod spatial_sweep;
mod splines;
mod steady_motion;
mod surface_tree;
mod sweep_cycle;
mod thin_bodies;
mod thin_sweeps;
mod translations;
