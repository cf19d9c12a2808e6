!> The motion of all unknowns at one instant.
module block_state
   use kinds, only: wp
   use number_types, only: vector_t, unknown_t, loop_state_t
   use plane_vectors, only: wrap_angle
   use drive_path, only: drive_path_t, drive_at
   use blocks, only: blocks_t, geometry_t, loop_angles
   implicit none
   private
   public :: unknown_t, loop_state_t, jacobian_t, state_t, new_state, set_drive_values, set_direction, set_values, &
      values_of, given, add_turns, largest_drive_rate

   !> Findings from the factors of a block's Jacobian.
   type :: jacobian_t
      integer :: sign_of = 1                         !< of the determinant
      real(wp) :: pivot = 1.0_wp                     !< the least; 1 of a direct block
      real(wp) :: inverse = 0.0_wp                   !< |J^-1|
   end type jacobian_t

   !> The motion found last: only values, no factors, no scratch. A checkpoint is an assignment.
   type :: state_t
      real(wp) :: t = 0.0_wp                         !< its time
      real(wp) :: change = 0.0_wp                    !< the largest change of a predicted value, rad or unit of length
      type(unknown_t), allocatable :: u(:)           !< (0:unknowns); 0 is the ground's angle
      type(loop_state_t), allocatable :: loop(:)     !< (loops)
      type(vector_t), allocatable :: own(:)          !< (body vectors) R d, if an angle of its own block rotates it
      type(vector_t), allocatable :: guide(:)        !< (slides) R e, their directions
      real(wp), allocatable :: drive_value(:, :)     !< (0:2, 0:drives) value, rate and acceleration of each drive
      real(wp) :: excursion = 0.0_wp                 !< of the drives off their chords (rad, characteristic lengths)
      type(jacobian_t), allocatable :: jacobian(:)   !< (blocks)
      logical, allocatable :: is_singular(:)         !< (blocks) without rates
      logical, allocatable :: crossed(:)             !< (blocks) the determinant has a new sign
   end type state_t

contains

   !> Makes room for the state of a mechanism.
   pure function new_state(b, drives) result(s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives                  !< how many drives there are
      type(state_t) :: s

      allocate (s%u(0:b%unknowns), s%loop(size(b%loops)), s%own(size(b%body_vectors)), s%guide(size(b%slides)))
      allocate (s%drive_value(0:2, 0:drives), source=0.0_wp)
      allocate (s%jacobian(size(b%list)))
      allocate (s%crossed(size(b%list)), s%is_singular(size(b%list)), source=.false.)
   end function new_state

   !> Puts the state at a parameter of the path of its drives, with value, rate and acceleration of each.
   pure subroutine set_drive_values(path, t, s)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: t                      !< the parameter, in the deck's unit of time
      type(state_t), intent(inout) :: s
      real(wp) :: f(3)
      integer :: i

      s%t = t
      do i = 1, size(path%laws)
         f = drive_at(path, i, t)
         s%drive_value(0:2, i) = path%unit(i)*f
      end do
   end subroutine set_drive_values

   !> Finds cosine and sine of an unknown, if it is an angle.
   pure subroutine set_direction(b, unknown, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: unknown                 !< the number of the unknown
      type(state_t), intent(inout) :: s

      if (unknown > b%orientations) return
      s%u(unknown)%c = cos(s%u(unknown)%value)
      s%u(unknown)%s = sin(s%u(unknown)%value)
   end subroutine set_direction

   !> Gives the unknowns of a block their values.
   pure subroutine set_values(b, i, values, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i                       !< the number of the block
      real(wp), intent(in) :: values(:)              !< (n) rad or unit of the loop
      type(state_t), intent(inout) :: s
      integer :: k

      do k = 1, size(values)
         s%u(b%unknown(b%list(i)%first + k - 1))%value = values(k)
         call set_direction(b, b%unknown(b%list(i)%first + k - 1), s)
      end do
   end subroutine set_values

   !> Gives the values (n) of the unknowns of a block.
   pure function values_of(b, i, s) result(x)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i                       !< the number of the block
      type(state_t), intent(in) :: s
      real(wp) :: x(b%list(i)%last - b%list(i)%first + 1)

      x = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
   end function values_of

   !> Gives the value that a row of a block requires: its constant and the value of its drive.
   pure real(wp) function given(b, x, i, row, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                       !< the number of the block
      integer, intent(in) :: row                     !< the number of the row in the block
      type(state_t), intent(in) :: s

      associate (k => b%list(i)%first_row + row - 1)
         given = x%rows(k)%constant + s%drive_value(0, b%rows(k)%drive)
      end associate
   end function given

   !> Adds to the angles of a block the whole turns that its drives ask for between two of them. Angles that such drives
   !> join turn together.
   pure subroutine add_turns(b, x, i, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                       !< the number of the block
      type(state_t), intent(inout) :: s
      real(wp) :: turns(0:b%list(i)%shape%n), off
      integer :: group(0:b%list(i)%shape%n), joins, to, m, k

      ! By column: angles of column 0 are known, and group 0 holds all that is joined to these.
      turns = 0.0_wp
      group = [(k, k=0, b%list(i)%shape%n)]
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            if (g%kind /= loop_angles .or. g%orientation > b%orientations) cycle
            off = given(b, x, i, g%row_x, s) - s%u(g%orientation)%value - turns(g%orientation_column) &
               + s%u(g%less)%value + turns(g%less_column)
            joins = group(g%orientation_column)
            to = group(g%less_column)
         end associate

         if (joins == 0) then
            off = -off
            joins = to
            to = 0
         end if
         if (joins == to) cycle
         where (group == joins)
            turns = turns + (off - wrap_angle(off))
            group = to
         end where
      end do
      call set_values(b, i, values_of(b, i, s) + turns(1:), s)
   end subroutine add_turns

   !> Gives the largest rate of a drive, in rad or its block's unit of length by time; 0 without drives.
   pure real(wp) function largest_drive_rate(s) result(rate)
      type(state_t), intent(in) :: s

      rate = maxval(abs(s%drive_value(1, :)))
   end function largest_drive_rate
end module block_state
