!> The blocks of a mechanism in solving order, as data made for fast evaluation: for each block the vector loops it
!> closes, split into the part that earlier blocks have found and the part it solves for. The numbers of the cards make
!> `geometry_t` of them: a variant has the same blocks with other numbers (`block_numbers`).
!>
!> Unknowns: 1 to `orientations` the angles of the orientations, then the slides. A block is one drive only, or the part
!> that the tree leaves of one or more Assur groups with their drives. Contract: a block needs unknowns of earlier
!> blocks only; every unknown belongs to exactly one block.
!>
!> Which blocks have to be solved: those whose unknowns move a link that a table names, those that they build
!> on, and no other; and of these again and again only what a drive moves.
module blocks
   use kinds, only: wp
   use number_types, only: vector_t, row_numbers_t, loop_numbers_t, link_numbers_t
   use cylinders, only: cylinder_t
   use klu, only: pattern_t
   use block_matrix, only: matrix_layout_t
   use spanning_tree, only: spanning_tree_t
   use loop_equations, only: equations_t, equation_numbers_t
   implicit none
   private
   public :: blocks_t, block_t, equation_row_t, block_loop_t, body_vector_t, slide_t, loop_components, &
      loop_projection, loop_angles, geometry_t, link_order_t, link_step_t, block_numbers_t, row_numbers_t, &
      loop_numbers_t
   public :: blocks_that_give, blocks_below, largest_known, known_to, own_unknowns

   integer, parameter :: loop_components = 1  !< x and y of a vector loop, or one of them
   integer, parameter :: loop_projection = 2  !< the projection of a vector loop
   integer, parameter :: loop_angles = 3      !< no vector loop: two angles of one block

   !> Unknowns, rows of equations and loops of a block. As many rows as unknowns, but in the first block where
   !> equations are too many.
   type :: block_t
      integer :: first = 1, last = 0              !< its unknowns: unknown(first:last) of the blocks
      integer :: first_row = 1, last_row = 0      !< its rows
      integer :: first_loop = 1, last_loop = 0    !< its vector loops
      type(matrix_layout_t) :: shape              !< of its Jacobian
      integer :: cleared = 0                      !< entries of its Jacobian to clear: none if body vectors set all
      logical :: explicit = .false.               !< one equation that is linear with coefficient 1
   end type block_t

   !> Row of an equation: = a constant + value of the drive; direct: unknown = other + sign_of (constant + value).
   type :: equation_row_t
      integer :: drive = 0                        !< whose value is added; 0: none
      integer :: other = 0                        !< direct: the unknown that is added; 0: the ground's angle
      integer :: pair = 0                         !< 0: a drive's equation
      logical :: angular = .false.                !< in radians, not lengths
      integer :: sign_of = 1                      !< 1 or -1
   end type equation_row_t

   !> A vector loop as one block has it: rows (0: none), the known body vectors, then those of the block's own angles.
   type :: block_loop_t
      integer :: kind = loop_components           !< which equations its rows are: loop_components, ...
      integer :: row_x = 0, row_y = 0             !< of the block; 0: none
      !> Its body vectors; from first_own on those that angles of the block rotate.
      integer :: first_vector = 1, first_own = 1, last_vector = 0
      integer :: first_slide = 1, last_slide = 0  !< its slides
      integer :: orientation = 0, orientation_column = 0   !< projection: turns with it; angles: the first
      integer :: less = 0, less_column = 0        !< angles: the one subtracted
      integer :: vector_loop = 0                  !< its number before the blocks were made; 0: none
      integer :: orientation_at = 0, less_at = 0        !< where their entries stand in the Jacobian
   end type block_loop_t

   !> `at`: where its entries stand in the Jacobian of its block, for the rows row_x and row_y. `source`: its number in
   !> the vector loops.
   type :: body_vector_t
      integer :: orientation = 0, column = 0, at(2) = 0   !< the angle that rotates it, and the column of that
      integer :: source = 0
   end type body_vector_t

   !> Columns are 0 for what is known; `at` as above, `orientation_at` those of the orientation's column.
   type :: slide_t
      integer :: orientation = 0, orientation_column = 0, unknown = 0, column = 0, at(2) = 0, orientation_at(2) = 0
      integer :: source = 0
   end type slide_t

   type :: block_numbers_t
      logical :: has_right_sides = .true.         !< not all its equations are = 0
      real(wp) :: coarse = 1.0_wp                 !< the largest of its loops'
      real(wp) :: lipschitz = 0.0_wp              !< bounds the change of its Jacobian over that of its unknowns
   end type block_numbers_t

   !> A moving link. Numbers are 0 for the ground, for no pair, no slide and no root.
   type :: link_step_t
      integer :: link = 0, parent = 0
      integer :: orientation = 0, parent_orientation = 0 !< the unknowns that rotate them
      integer :: slide = 0                              !< its unknown
      integer :: root = 0                               !< the unknown that is its x; y is the next
      logical :: has_body_vector = .false.              !< its origin is not the point that joins it to the parent
      type(link_numbers_t) :: numbers
   end type link_step_t

   !> The links to be moved, the wanted ones first, parents before their children; and those that stay.
   type :: link_order_t
      type(link_step_t), allocatable :: links(:)
      integer, allocatable :: ground(:)                 !< numbers of the ground links
      integer :: wanted = 0                             !< so many links are wanted, or parents of wanted ones
      real(wp), allocatable :: ground_position(:, :)    !< (3, ground links)
      real(wp) :: origin(2) = 0.0_wp                    !< what places are counted from, in the deck's unit
   end type link_order_t

   !> What the numbers of the cards make of the blocks.
   type :: geometry_t
      real(wp) :: tolerance = 0.0_wp              !< relative, of corrections; 0: the limit of rounding
      real(wp) :: span = 1.0_wp                   !< the characteristic length, in the deck's unit
      real(wp) :: closing = 0.0_wp                !< closing tolerance of redundant equations (unit of the loop, rad)
      type(equation_numbers_t) :: equations       !< their unit of length: the power of two next to `span`
      type(block_numbers_t), allocatable :: blocks(:)
      type(row_numbers_t), allocatable :: rows(:)
      type(loop_numbers_t), allocatable :: loops(:)
      type(vector_t), allocatable :: d(:)         !< (body vectors) in the axes of the orientation, unit of the loop
      type(vector_t), allocatable :: e(:)         !< (slides) along the guide, with its sign in the loop
      real(wp), allocatable :: unit(:)            !< (0:unknowns) of a slide; 1 of an angle
      type(link_order_t) :: chain                      !< of the links: those that are asked for, then the others
      type(cylinder_t), allocatable :: cylinders(:)
   end type geometry_t

   type :: blocks_t
      integer :: orientations = 0, unknowns = 0   !< angles; angles, slides and places of roots together
      logical :: solvable = .false.               !< each unknown has an equation of its own
      integer :: redundant = 0                    !< equations that found no unknown
      integer :: free = 0                         !< unknowns that found no equation
      integer, allocatable :: loose(:)            !< if there are any: all unknowns that could be free in their place
      type(block_t), allocatable :: list(:)
      integer, allocatable :: unknown(:)          !< by block
      integer, allocatable :: block_of(:)         !< (unknowns)
      type(equation_row_t), allocatable :: rows(:)
      integer, allocatable :: equation(:)         !< (rows) its number among the equations
      type(block_loop_t), allocatable :: loops(:)
      type(body_vector_t), allocatable :: body_vectors(:)
      type(slide_t), allocatable :: slides(:)
      type(pattern_t), allocatable :: patterns(:) !< of the blocks with a sparse Jacobian
      type(spanning_tree_t) :: tree
      ! For the requests:
      integer, allocatable :: needed(:), moving(:)      !< blocks that are solved at first, and at every step
      integer, allocatable :: ratios(:)                 !< numbers of the drives by which ratios are asked for
      integer, allocatable :: joint(:, :)               !< (2, revolute pairs) the links of each
      logical, allocatable :: is_found(:)               !< (links) that a table needs and whose angle no drive gives
      type(equations_t) :: equations              !< of which they were made
   end type blocks_t

contains

   !> Lists the unknowns of a block, in its order.
   pure function own_unknowns(b, i) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i   !< the number of the block
      integer :: list(b%list(i)%last - b%list(i)%first + 1)

      list = b%unknown(b%list(i)%first:b%list(i)%last)
   end function own_unknowns

   !> Lists a block and those that it builds on, in solving order.
   function blocks_below(b, i) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i   !< the number of the block
      integer, allocatable :: list(:)
      logical :: need(0:b%unknowns)
      integer :: k

      need = .false.
      list = blocks_that_give(b, [(k == i, k=1, size(b%list))], need)
   end function blocks_below

   !> Lists the blocks that are wanted and those on which they build, in solving order.
   function blocks_that_give(b, taken, need) result(list)
      type(blocks_t), intent(in) :: b
      logical, intent(in) :: taken(:)        !< (blocks) the block is wanted
      logical, intent(inout) :: need(0:)     !< (0:unknowns) the unknown is wanted; then also if a block needs it
      integer, allocatable :: list(:)
      logical :: needed(size(taken))
      integer :: i

      do i = size(taken), 1, -1
         needed(i) = taken(i) .or. any(need(own_unknowns(b, i)))
         if (needed(i)) need(known_to(b, i)) = .true.
      end do
      list = pack([(i, i=1, size(taken))], needed)
   end function blocks_that_give

   !> Gives the largest mark of the unknowns on which a block builds; 0 at least.
   pure integer function largest_known(b, i, mark) result(largest)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i               !< the number of the block
      integer, intent(in) :: mark(0:)        !< (0:unknowns) any numbers; 0 for the block's own unknowns

      largest = maxval([0, mark(known_to(b, i))])
   end function largest_known

   !> Lists the unknowns in the equations of a block, those of other blocks and its own, some more than once; 0 for the
   !> ground.
   pure function known_to(b, i) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i   !< the number of the block
      integer, allocatable :: list(:)

      associate (block => b%list(i))
         list = b%rows(block%first_row:block%last_row)%other
         if (block%first_loop > block%last_loop) return
         associate (loops => b%loops(block%first_loop:block%last_loop))
            associate (v => loops(1)%first_vector, w => loops(size(loops))%last_vector, &
               s => loops(1)%first_slide, t => loops(size(loops))%last_slide)
               list = [list, loops%orientation, loops%less, b%body_vectors(v:w)%orientation, &
                  b%slides(s:t)%orientation, b%slides(s:t)%unknown]
            end associate
         end associate
      end associate
   end function known_to
end module blocks
