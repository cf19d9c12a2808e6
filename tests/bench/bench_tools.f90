!> Tests. What a measurement needs beside a clock: the spread of a sample, the slope of a line, the memory taken.
module bench_tools
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use study, only: median, seconds
   implicit none
   private
   public :: spread_t, spread_of, slope, memory_peak, plain_reading, figure

   !> The middle of a sample, and its ends.
   type :: spread_t
      real(wp) :: median = 0.0_wp, least = 0.0_wp, most = 0.0_wp
   end type spread_t

contains

   !> The spread of the sample `x`.
   pure type(spread_t) function spread_of(x) result(s)
      real(wp), intent(in) :: x(:)

      s = spread_t(median(x), minval(x), maxval(x))
   end function spread_of

   !> Least squares: the slope of log `y` over log `x`.
   pure real(wp) function slope(x, y)
      real(wp), intent(in) :: x(:), y(:)
      real(wp) :: u(size(x))

      u = log(x) - sum(log(x))/size(x)
      slope = sum(u*log(y))/sum(u*u)
   end function slope

   !> The most memory that this process has held so far, in millions of bytes; 0 where the system does not tell.
   real(wp) function memory_peak() result(size)
      character(200) :: line
      integer :: unit, status

      size = 0.0_wp
      open (newunit=unit, file='/proc/self/status', action='read', status='old', iostat=status)
      if (status /= 0) return
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (line(:6) /= 'VmHWM:') cycle
         read (line(7:index(line, 'kB') - 1), *, iostat=status) size
         size = size*1024.0e-6_wp
         exit
      end do
      close (unit)
   end function memory_peak

   !> Seconds taken to read the file `path` and count its lines, and no more.
   real(wp) function plain_reading(path) result(time)
      character(*), intent(in) :: path
      integer, parameter :: block_length = 65536
      character(block_length) :: buffer
      integer :: unit, status, i, lines
      integer(int64) :: length, at

      time = seconds()
      open (newunit=unit, file=path, access='stream', action='read', status='old')
      inquire (unit=unit, size=length)
      lines = 0
      do at = 1, length, block_length
         i = int(min(int(block_length, int64), length - at + 1))
         read (unit, iostat=status) buffer(:i)
         if (status /= 0) exit
         lines = lines + count_ends(buffer(:i))
      end do
      close (unit)
      time = seconds() - time
      if (lines == 0) error stop 'AN EMPTY DECK'
   end function plain_reading

   pure integer function count_ends(text) result(lines)
      character(*), intent(in) :: text
      integer :: i

      lines = 0
      do i = 1, len(text)
         if (text(i:i) == new_line('a')) lines = lines + 1
      end do
   end function count_ends

   !> `x` in 8 columns with three digits or so; '-' where it is not a number above zero.
   function figure(x) result(text)
      real(wp), intent(in) :: x
      character(8) :: text

      if (.not. x > 0.0_wp) then
         text = '       -'
      else if (x < 9.995_wp) then
         write (text, '(f8.2)') x
      else if (x < 99.95_wp) then
         write (text, '(f8.1)') x
      else
         write (text, '(i8)') nint(x)
      end if
   end function figure
end module bench_tools
