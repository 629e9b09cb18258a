-- An instance of xy_stage_x_pwm_avalon, to copy into a design
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;
use work.xy_stage_x_pwm_avalon_pkg.all;

entity xy_stage_x_pwm_avalon_instance is
    port (
        clk              : in  std_logic;
        rst              : in  std_logic;
        avs_address      : in  std_logic_vector(7 downto 0);
        avs_read         : in  std_logic;
        avs_write        : in  std_logic;
        avs_byteenable   : in  std_logic_vector(3 downto 0);
        avs_writedata    : in  std_logic_vector(31 downto 0);
        feed             : in  std_logic;
        duty             : in  std_logic_vector(16 downto 0);  -- signed
        sync             : in  std_logic;
        fault_n          : in  std_logic;
        pll_locked       : in  std_logic;
        filtered_fault_n : in  std_logic_vector(1 downto 0);
        avs_readdata     : out std_logic_vector(31 downto 0);
        irq              : out std_logic;
        a_high           : out std_logic;
        a_low            : out std_logic;
        b_high           : out std_logic;
        b_low            : out std_logic;
        running          : out std_logic;
        tripped          : out std_logic;
        valley           : out std_logic;
        peak             : out std_logic;
        trigger          : out std_logic
    );
end entity;

architecture template of xy_stage_x_pwm_avalon_instance is
begin
    u_xy_stage_x_pwm_avalon : xy_stage_x_pwm_avalon
        port map (
            clk              => clk,
            rst              => rst,
            avs_address      => avs_address,
            avs_read         => avs_read,
            avs_write        => avs_write,
            avs_byteenable   => avs_byteenable,
            avs_writedata    => avs_writedata,
            feed             => feed,
            duty             => duty,
            sync             => sync,
            fault_n          => fault_n,
            pll_locked       => pll_locked,
            filtered_fault_n => filtered_fault_n,
            avs_readdata     => avs_readdata,
            irq              => irq,
            a_high           => a_high,
            a_low            => a_low,
            b_high           => b_high,
            b_low            => b_low,
            running          => running,
            tripped          => tripped,
            valley           => valley,
            peak             => peak,
            trigger          => trigger
        );
end architecture;
