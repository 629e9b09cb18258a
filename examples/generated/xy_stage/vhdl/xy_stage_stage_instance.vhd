-- An instance of xy_stage_stage, to copy into a design
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;
use work.xy_stage_stage_pkg.all;

entity xy_stage_stage_instance is
    port (
        clk              : in  std_logic;
        rst              : in  std_logic;
        avs_address      : in  std_logic_vector(9 downto 0);
        avs_read         : in  std_logic;
        avs_write        : in  std_logic;
        avs_byteenable   : in  std_logic_vector(3 downto 0);
        avs_writedata    : in  std_logic_vector(31 downto 0);
        emergency_stop_n : in  std_logic;
        pll_locked       : in  std_logic;
        x_a              : in  std_logic;
        x_b              : in  std_logic;
        x_z              : in  std_logic;
        x_limit_plus_n   : in  std_logic;
        x_limit_minus_n  : in  std_logic;
        x_home           : in  std_logic;
        x_drive_ready    : in  std_logic;
        x_drive_fault_n  : in  std_logic;
        x_fault_n        : in  std_logic;
        y_a              : in  std_logic;
        y_b              : in  std_logic;
        y_z              : in  std_logic;
        y_limit_plus_n   : in  std_logic;
        y_limit_minus_n  : in  std_logic;
        y_home           : in  std_logic;
        y_drive_ready    : in  std_logic;
        y_drive_fault_n  : in  std_logic;
        y_fault_n        : in  std_logic;
        avs_readdata     : out std_logic_vector(31 downto 0);
        irq              : out std_logic;
        tick             : out std_logic;
        x_a_high         : out std_logic;
        x_a_low          : out std_logic;
        x_b_high         : out std_logic;
        x_b_low          : out std_logic;
        x_pwm_trigger    : out std_logic;
        x_drive_enable   : out std_logic;
        x_brake_release  : out std_logic;
        y_a_high         : out std_logic;
        y_a_low          : out std_logic;
        y_b_high         : out std_logic;
        y_b_low          : out std_logic;
        y_pwm_trigger    : out std_logic;
        y_drive_enable   : out std_logic;
        y_brake_release  : out std_logic
    );
end entity;

architecture template of xy_stage_stage_instance is
begin
    u_xy_stage_stage : xy_stage_stage
        port map (
            clk              => clk,
            rst              => rst,
            avs_address      => avs_address,
            avs_read         => avs_read,
            avs_write        => avs_write,
            avs_byteenable   => avs_byteenable,
            avs_writedata    => avs_writedata,
            emergency_stop_n => emergency_stop_n,
            pll_locked       => pll_locked,
            x_a              => x_a,
            x_b              => x_b,
            x_z              => x_z,
            x_limit_plus_n   => x_limit_plus_n,
            x_limit_minus_n  => x_limit_minus_n,
            x_home           => x_home,
            x_drive_ready    => x_drive_ready,
            x_drive_fault_n  => x_drive_fault_n,
            x_fault_n        => x_fault_n,
            y_a              => y_a,
            y_b              => y_b,
            y_z              => y_z,
            y_limit_plus_n   => y_limit_plus_n,
            y_limit_minus_n  => y_limit_minus_n,
            y_home           => y_home,
            y_drive_ready    => y_drive_ready,
            y_drive_fault_n  => y_drive_fault_n,
            y_fault_n        => y_fault_n,
            avs_readdata     => avs_readdata,
            irq              => irq,
            tick             => tick,
            x_a_high         => x_a_high,
            x_a_low          => x_a_low,
            x_b_high         => x_b_high,
            x_b_low          => x_b_low,
            x_pwm_trigger    => x_pwm_trigger,
            x_drive_enable   => x_drive_enable,
            x_brake_release  => x_brake_release,
            y_a_high         => y_a_high,
            y_a_low          => y_a_low,
            y_b_high         => y_b_high,
            y_b_low          => y_b_low,
            y_pwm_trigger    => y_pwm_trigger,
            y_drive_enable   => y_drive_enable,
            y_brake_release  => y_brake_release
        );
end architecture;
